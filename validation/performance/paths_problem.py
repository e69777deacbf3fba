"""The sampling benchmark: B = |ξ|²/2, A = 1, v = 0, ds = 0.2, and how a rate is taken.

Independent of fpsolve, so that the peers share the statement of the problem and the
clock with our sampler and nothing else.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from timing import measure

NOISE = 1.0
DS = 0.2
SEED = 20080611
# E|ξ|² of exp(-|ξ|²/2), what every sampler tends to but for its bias.
STATIONARY_MEAN_SQUARE = 2.0

# Returns the end positions (xi1, xi2) of `n_paths` paths after `n_steps` steps of DS.
Sampler = Callable[[], tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class Rate:
    """Path-steps per CPU second of one sampler, and a check of what it sampled.

    Attributes
    ----------
    name, note : str
    rate : float
        Path-steps per second of process CPU time, all threads, median of the samples.
    wall_rate : float
        The same per elapsed second.
    mean_square, standard_error : float
        E|ξ|² of the paths that were timed, at the last step.
    """

    name: str
    rate: float
    wall_rate: float
    n_paths: int
    n_steps: int
    mean_square: float
    standard_error: float
    note: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Return plain values, for JSON."""
        return asdict(self)


def measure_rate(
    name: str,
    sample: Sampler,
    n_paths: int,
    n_steps: int,
    note: str = "",
    *,
    quick: bool = False,
) -> Rate:
    """Time `sample`, called once before: compilation is never counted."""
    sample()
    timed = measure(sample, samples=3 if quick else 9, at_least=0.0)
    xi1, xi2 = timed.value
    square = np.square(xi1) + np.square(xi2)
    return Rate(
        name=name,
        rate=n_paths * n_steps / timed.cpu,
        wall_rate=n_paths * n_steps / timed.wall,
        n_paths=n_paths,
        n_steps=n_steps,
        mean_square=float(np.mean(square)),
        standard_error=float(np.std(square) / np.sqrt(max(square.size, 1))),
        note=note,
    )


def stay_on_one_core() -> None:
    """Bind this process to one core, where the operating system can.

    A library that starts threads in spite of the environment variables then shares
    that core, and its process time is still what it used.
    """
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})


def standard_equilibrium(n_paths: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(xi1, xi2, alpha) drawn from exp(-|ξ|²/2) and the uniform angle."""
    rng = np.random.default_rng(SEED)
    xi1, xi2 = rng.standard_normal((2, n_paths))
    return xi1, xi2, rng.uniform(0.0, 2 * np.pi, n_paths)
