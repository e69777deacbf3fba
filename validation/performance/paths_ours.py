"""Rates, thread scaling and stationary bias of `fpsolve.sample_paths`.

What is timed is a whole call: checks, random numbers, steps, and the end positions.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

import numba
import numpy as np
from paths_problem import DS, NOISE, SEED, Rate, measure_rate, standard_equilibrium

import fpsolve as fp
from fpsolve.paths import EquilibriumLaw

NAME = "fpsolve"
METHODS = ("splitting", "heun", "euler_maruyama")


def quartic() -> fp.CallablePotential:
    """B = (ξ₁⁴ + 2 ξ₂⁴)/4 as a user would write it, with numpy."""
    return fp.CallablePotential(
        lambda xi1, xi2: (xi1**4 + 2 * xi2**4) / 4,
        lambda xi1, xi2: (xi1**3, 2 * xi2**3),
    )


Model = fp.LayDownModel | fp.SmoothLayDownModel

MODELS: dict[str, Callable[[], Model]] = {
    "quadratic B": lambda: fp.LayDownModel(fp.QuadraticPotential(), NOISE),
    "quadratic B, anisotropic": lambda: fp.LayDownModel(
        fp.QuadraticPotential(1.0, 2.0), NOISE
    ),
    "linear B": lambda: fp.LayDownModel(fp.LinearPotential(), NOISE),
    "quartic B": lambda: fp.LayDownModel(fp.PowerPotential(4), NOISE),
    "B from Python functions": lambda: fp.LayDownModel(quartic(), NOISE),
    "moving belt": lambda: fp.LayDownModel(
        fp.QuadraticPotential(), NOISE, fp.MovingBelt(0.1)
    ),
    "smooth, R = 0.1": lambda: fp.SmoothLayDownModel(
        fp.QuadraticPotential(), 0.1, NOISE
    ),
    "rotating nozzle": lambda: fp.LayDownModel(
        fp.QuadraticPotential(), NOISE, fp.RotatingNozzle(0.1, 0.5, 2.0)
    ),
}


def end_positions(
    model: Model, method: str, n_paths: int, n_steps: int
) -> tuple[np.ndarray, np.ndarray]:
    """(ξ₁, ξ₂) of paths from the equilibrium of |ξ|²/2 after `n_steps` steps."""
    xi1, xi2, alpha = standard_equilibrium(n_paths)
    paths = fp.sample_paths(
        model, n_paths, n_steps * DS, DS, seed=SEED, method=method,
        initial=(np.stack((xi1, xi2), axis=1), alpha),
    )  # fmt: skip
    return paths.xi[-1, :, 0], paths.xi[-1, :, 1]


def rates(*, quick: bool) -> list[Rate]:
    """Every method for the benchmark problem, then the other models."""
    n_paths, n_steps = (1000, 20) if quick else (20_000, 1000)
    cases = [("quadratic B", method) for method in METHODS]
    cases += [(name, "splitting") for name in MODELS if name != "quadratic B"]
    found = []
    for name, method in cases:
        model = MODELS[name]()

        def sample(model=model, method=method):
            return end_positions(model, method, n_paths, n_steps)

        note = f"{method}, {name}"
        found.append(measure_rate(NAME, sample, n_paths, n_steps, note, quick=quick))
    return found


@dataclass(frozen=True)
class Scaling:
    """Path-steps per elapsed second with one thread and with two, fastest of nine.

    Elapsed time, unlike CPU time, grows with whatever else the machine does.
    """

    one: float
    two: float

    @property
    def gain(self) -> float:
        """How many times faster two threads are."""
        return self.two / self.one

    def to_dict(self) -> dict[str, float]:
        """Return plain values, for JSON."""
        return asdict(self) | {"gain": self.gain}


def scaling(*, quick: bool) -> Scaling:
    """One thread and two in turn, so that both see the same machine."""
    n_paths, n_steps = (2000, 20) if quick else (40_000, 1000)
    model = MODELS["quadratic B"]()
    seconds: dict[int, list[float]] = {1: [], 2: []}
    for _ in range(3 if quick else 9):
        for n_threads, watches in seconds.items():
            numba.set_num_threads(n_threads)
            end_positions(model, "splitting", n_paths, n_steps // 10)
            began = time.perf_counter()
            end_positions(model, "splitting", n_paths, n_steps)
            watches.append(time.perf_counter() - began)
    one, two = (n_paths * n_steps / min(seconds[n]) for n in (1, 2))
    return Scaling(one, two)


@dataclass(frozen=True)
class Bias:
    """Stationary E|ξ|² − 2 of a method with the step ds, and its standard error."""

    method: str
    ds: float
    bias: float
    standard_error: float

    def to_dict(self) -> dict[str, Any]:
        """Return plain values, for JSON."""
        return asdict(self)


STEPS = {
    "splitting": (0.4, 0.2, 0.1),
    "heun": (0.2,),
    "euler_maruyama": (0.2, 0.1, 0.05),
}
N_RUNS = {"splitting": 40, "heun": 8, "euler_maruyama": 8}


def stationary_bias(method: str, ds: float, *, n_paths: int, n_runs: int) -> Bias:
    """From independent runs, each averaged over several s after s = 20.

    The runs start from the exact equilibrium; what is left of it after s = 20, about
    e^{−0.7·20} of the bias, does not count.
    """
    model = fp.LayDownModel(fp.QuadraticPotential(), NOISE)
    means = []
    for run in range(n_runs):
        paths = fp.sample_paths(
            model, n_paths, 60.0, ds, seed=SEED + 1 + run, method=method,
            initial=EquilibriumLaw(model.potential), save_at=np.arange(20.0, 61.0, 4.0),
            keep=False,
        )  # fmt: skip
        means.append(float(np.mean(paths.moments()["mean_square"][0])))
    error = statistics.stdev(means) / len(means) ** 0.5
    return Bias(method, ds, statistics.fmean(means) - 2.0, error)


def biases(*, quick: bool) -> list[Bias]:
    """Bias of every method at its steps; the splitting's is small and needs more."""
    if quick:
        cases = [("splitting", 0.2), ("euler_maruyama", 0.2)]
        return [stationary_bias(*case, n_paths=1000, n_runs=4) for case in cases]
    return [
        stationary_bias(method, ds, n_paths=100_000, n_runs=N_RUNS[method])
        for method, steps in STEPS.items()
        for ds in steps
    ]
