"""What paths are compared with: densities, their moments and step errors, by s."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import told_apart
from fpsolve.density.solution import Solution
from fpsolve.density.steady_state import SteadyState
from fpsolve.evolution.schedule import index_of
from fpsolve.grids import row_sums as functionals
from fpsolve.model.fibre import FibreModel

__all__ = ["MOMENTS", "Reference", "describe", "model_of", "places", "reference_at"]

MOMENTS = (*functionals.MOMENTS, "mean_square")


@dataclass(frozen=True)
class Reference:
    """A density at one s.

    Attributes
    ----------
    density : ndarray, shape (n1, n2, n_alpha)
    moments, errors : mapping
        Values of `MOMENTS`, and their estimated errors (NaN if unknown): of a run in
        ds, of a stationary density in all.
    distance : float
        Estimated L1 error of the density; NaN if unknown.
    half_step_errors : mapping
        What a run with ds/2 alone, and paths with that step, would be off.
    half_step_distance : float
        The same in L1.
    """

    density: Array
    moments: Mapping[str, float]
    errors: Mapping[str, float]
    distance: float
    half_step_errors: Mapping[str, float]
    half_step_distance: float


def places(
    density: Solution | SteadyState, available: Array, s: float | Iterable[float] | None
) -> Array:
    """Arclengths to compare at: those asked for, else all that both sides have.

    A stationary density belongs to every s; it is compared with the last paths.
    """
    if s is not None:
        chosen = np.atleast_1d(np.asarray(s, dtype=np.float64))
    elif isinstance(density, SteadyState):
        chosen = available[-1:]
    else:
        chosen = np.array([one for one in density.saved_s if _among(one, available)])
    missing = [float(one) for one in chosen if not _among(one, available)]
    if missing or not chosen.size:
        texts = told_apart(*missing, *available)
        wanted = ", ".join(texts[: len(missing)]) or "none in common"
        saved = ", ".join(texts[len(missing) :])
        raise ValueError(
            f"`s` must be saved by density and paths, got {wanted} and paths at "
            f"{saved}; name the same arclengths in `save_at` of both."
        )
    return chosen


def reference_at(density: Solution | SteadyState, s: float) -> Reference:
    """The density at s, with moments and errors.

    The moments of an extrapolated run are the extrapolated moments.
    """
    if isinstance(density, SteadyState):
        return _stationary_reference(density)
    record = int(np.argmin(np.abs(density.series["s"] - s)))
    moments, errors = _recorded(density, record)
    distance = _distance(density, s)
    moments["mean_square"], errors["mean_square"] = _mean_square(moments, errors)
    # The Richardson estimate is that of the finer run, with ds/2.
    return Reference(density.density(s), moments, errors, distance, errors, distance)


def _stationary_reference(density: SteadyState) -> Reference:
    """A stationary density with all of its error, and what one step would do."""
    moments, errors = density.moments(), dict(density.moment_errors)
    quarter = {name: size / 4 for name, size in density.splitting.items()}
    for one in (errors, quarter):
        value, one["mean_square"] = _mean_square(moments, one)
    moments["mean_square"] = value
    return Reference(
        density.density, moments, errors, density.error, quarter, quarter["density"]
    )


def describe(density: Solution | SteadyState) -> dict[str, Any]:
    """Where a density comes from: name, options and steps."""
    if isinstance(density, SteadyState):
        return {
            "name": "steady_state", "options": {}, "ds": density.ds,
            "extrapolated": density.extrapolated, "residual": density.residual,
        }  # fmt: skip
    return {
        "name": density.scheme["name"],
        "options": density.scheme["options"],
        "ds": density.ds,
        "extrapolated": density.errors is not None,
    }


def model_of(density: Solution | SteadyState, paths: Any) -> FibreModel | None:
    """The model of a density, or of the paths where it does not know its own."""
    found = paths.model if density.model is None else density.model
    return found if isinstance(found, FibreModel) else None


def _among(s: float, available: Array) -> bool:
    return index_of(available, s) is not None


def _recorded(
    solution: Solution, record: int
) -> tuple[dict[str, float], dict[str, float]]:
    """Moments of a run at one of its records, and their Richardson estimates."""
    estimates = solution.errors or {}
    moments, errors = {}, {}
    for name in functionals.MOMENTS:
        moments[name] = float(solution.series[name][record])
        known = name in estimates
        errors[name] = float(estimates[name][record]) if known else math.nan
    return moments, errors


def _distance(solution: Solution, s: float) -> float:
    if solution.errors is None:
        return math.nan
    place = int(np.argmin(np.abs(solution.saved_s - s)))
    return float(solution.errors["density_l1"][place])


def _mean_square(
    moments: Mapping[str, float], errors: Mapping[str, float]
) -> tuple[float, float]:
    """E ‖ξ‖² = Var ξ₁ + Var ξ₂ + ‖E ξ‖², and its error to first order."""
    value = error = 0.0
    for axis in ("xi1", "xi2"):
        mean = moments[f"mean_{axis}"]
        value += moments[f"variance_{axis}"] + mean**2
        error += errors[f"variance_{axis}"] + 2 * abs(mean) * errors[f"mean_{axis}"]
    return value, error
