"""Peer: Euler-Maruyama as a careful user would write it with numba and `np.random`.

Arrangements of the same loops; which is the fastest depends on the processor. The one
with a `numpy.random.Generator` draws normal numbers by the faster ziggurat method.
"""

# numba's `np.random.normal` is what is compared here.
# ruff: noqa: NPY002
from __future__ import annotations

import math
from collections.abc import Callable

import numba
import numpy as np
from paths_problem import DS, NOISE, Rate, measure_rate, standard_equilibrium

NAME = "numba Euler-Maruyama"


@numba.njit(error_model="numpy")
def path_by_path(xi1, xi2, alpha, n_steps, ds, noise):
    """One path after the other; its state stays in registers."""
    deviation = noise * math.sqrt(ds)
    for k in range(xi1.size):
        x, y, a = xi1[k], xi2[k], alpha[k]
        for _ in range(n_steps):
            cosine, sine = math.cos(a), math.sin(a)
            a += (x * sine - y * cosine) * ds + deviation * np.random.normal()
            x += cosine * ds
            y += sine * ds
        xi1[k], xi2[k], alpha[k] = x, y, a


@numba.njit(error_model="numpy")
def step_by_step(xi1, xi2, alpha, n_steps, ds, noise):
    """All paths one step, then the next; a number drawn where it is used."""
    deviation = noise * math.sqrt(ds)
    for _ in range(n_steps):
        for k in range(xi1.size):
            cosine, sine = math.cos(alpha[k]), math.sin(alpha[k])
            force = xi1[k] * sine - xi2[k] * cosine
            alpha[k] += force * ds + deviation * np.random.normal()
            xi1[k] += cosine * ds
            xi2[k] += sine * ds


@numba.njit(error_model="numpy")
def step_by_step_drawn_first(xi1, xi2, alpha, n_steps, ds, noise):
    """All paths one step, then the next; the numbers of a step drawn as an array."""
    deviation = noise * math.sqrt(ds)
    for _ in range(n_steps):
        kicks = np.random.normal(0.0, deviation, xi1.size)
        for k in range(xi1.size):
            cosine, sine = math.cos(alpha[k]), math.sin(alpha[k])
            alpha[k] += (xi1[k] * sine - xi2[k] * cosine) * ds + kicks[k]
            xi1[k] += cosine * ds
            xi2[k] += sine * ds


@numba.njit(error_model="numpy")
def path_by_path_generator(xi1, xi2, alpha, n_steps, ds, noise, rng):
    """As `path_by_path`, with numbers from a Generator."""
    deviation = noise * math.sqrt(ds)
    for k in range(xi1.size):
        x, y, a = xi1[k], xi2[k], alpha[k]
        for _ in range(n_steps):
            cosine, sine = math.cos(a), math.sin(a)
            a += (x * sine - y * cosine) * ds + deviation * rng.standard_normal()
            x += cosine * ds
            y += sine * ds
        xi1[k], xi2[k], alpha[k] = x, y, a


@numba.njit
def seed_numba(seed):
    """Seed numba's own generator, which is not numpy's."""
    np.random.seed(seed)


ARRANGEMENTS: dict[str, Callable[..., None]] = {
    "path by path": path_by_path,
    "step by step, drawn in the loop": step_by_step,
    "step by step, drawn first": step_by_step_drawn_first,
    "path by path, Generator": path_by_path_generator,
}


def rates(*, quick: bool) -> list[Rate]:
    """Rates of all arrangements."""
    n_paths, n_steps = (1000, 20) if quick else (10_000, 200)
    found = []
    for note, kernel in ARRANGEMENTS.items():
        seed_numba(1)
        last = (np.random.default_rng(1),) if "Generator" in note else ()

        def sample(kernel=kernel, last=last):
            state = standard_equilibrium(n_paths)
            kernel(*state, n_steps, DS, NOISE, *last)
            return state[:2]

        found.append(measure_rate(NAME, sample, n_paths, n_steps, note, quick=quick))
    return found
