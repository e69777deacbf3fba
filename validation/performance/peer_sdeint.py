"""Peer: mattja/sdeint, `itoEuler`.

sdeint integrates one system per call. The first two variants call it once per path, as
it is meant; the drift is plain Python or compiled. The last one stacks many paths as
one system whose noise matrix is mostly zero, the fastest use of sdeint known to us.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numba
import numpy as np
import sdeint
from paths_problem import DS, NOISE, SEED, Rate, measure_rate, standard_equilibrium

NAME = "sdeint"
ONE_PATH_NOISE = np.array([[0.0], [0.0], [NOISE]])
N_STACKED = 100


def drift(state: np.ndarray, s: float) -> np.ndarray:
    """(cos α, sin α, ξ₁ sin α − ξ₂ cos α) of one path."""
    xi1, xi2, alpha = state
    cosine, sine = math.cos(alpha), math.sin(alpha)
    return np.array((cosine, sine, xi1 * sine - xi2 * cosine))


@numba.njit
def compiled_drift(state, s):
    """The same, compiled."""
    cosine, sine = math.cos(state[2]), math.sin(state[2])
    out = np.empty(3)
    out[0], out[1] = cosine, sine
    out[2] = state[0] * sine - state[1] * cosine
    return out


def stacked_drift(state: np.ndarray, s: float) -> np.ndarray:
    """The same for many paths: all ξ₁, all ξ₂, all α."""
    xi1, xi2, alpha = state.reshape(3, -1)
    cosine, sine = np.cos(alpha), np.sin(alpha)
    return np.concatenate((cosine, sine, xi1 * sine - xi2 * cosine))


def one_by_one(
    drift: Callable[..., np.ndarray], n_paths: int, n_steps: int
) -> tuple[np.ndarray, np.ndarray]:
    """End positions of paths, one call of sdeint for each."""
    rng = np.random.default_rng(SEED)
    s = DS * np.arange(n_steps + 1)
    starts = np.stack(standard_equilibrium(n_paths), axis=1)
    ends = np.array([
        sdeint.itoEuler(drift, lambda *_: ONE_PATH_NOISE, start, s, generator=rng)[-1]
        for start in starts
    ])  # fmt: skip
    return ends[:, 0], ends[:, 1]


def stacked(n_paths: int, n_steps: int) -> tuple[np.ndarray, np.ndarray]:
    """End positions of paths, all in one call of sdeint."""
    noise = np.zeros((3 * n_paths, n_paths))
    noise[2 * n_paths :] = NOISE * np.eye(n_paths)
    end = sdeint.itoEuler(
        stacked_drift,
        lambda *_: noise,
        np.concatenate(standard_equilibrium(n_paths)),
        DS * np.arange(n_steps + 1),
        generator=np.random.default_rng(SEED),
    )[-1]
    return end[:n_paths], end[n_paths : 2 * n_paths]


def rates(*, quick: bool) -> list[Rate]:
    """Rates of all variants."""
    n_paths, n_steps = (2, 50) if quick else (20, 1000)
    found = [
        measure_rate(
            NAME,
            lambda function=function: one_by_one(function, n_paths, n_steps),
            n_paths,
            n_steps,
            note,
            quick=quick,
        )
        for note, function in {
            "one path a call": drift,
            "one path a call, compiled drift": compiled_drift,
        }.items()
    ]
    together = measure_rate(
        NAME,
        lambda: stacked(N_STACKED, n_steps),
        N_STACKED,
        n_steps,
        f"{N_STACKED} paths stacked",
        quick=quick,
    )
    return [*found, together]
