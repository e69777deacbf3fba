"""How far the truncations of an evolution agree, and what would help them."""

from __future__ import annotations

import math

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.errors import ToleranceError
from fpsolve.model.fibre import FibreModel
from fpsolve.spectral.evolution.smooth_solution import SmoothSpectralSolution
from fpsolve.spectral.evolution.solution import SpectralSolution
from fpsolve.spectral.work import Work

__all__ = ["excess", "failure"]

Evolved = SpectralSolution | SmoothSpectralSolution


def worst_errors(result: Evolved) -> Array:
    """Largest error at every s, relative where a number is above one."""
    errors = [
        errors / np.maximum(1.0, np.abs(result.series[name]))
        for name, errors in result.errors.items()
    ]
    worst: Array = np.max(errors, axis=0)
    return np.where(np.isnan(worst), np.inf, worst)


def excess(result: Evolved) -> float:
    """Largest error over what is allowed."""
    return float(worst_errors(result).max()) / result.tolerance


def remedy(result: Evolved) -> str:
    """What would help, by where the errors are."""
    met = worst_errors(result) <= result.tolerance
    if met[-1]:
        first = result.s[int(np.flatnonzero(~met)[-1]) + 1]
        return f"it is reached from s = {first:g} on; ask for later `s`"
    return "raise `memory_limit` or `tolerance`, or start from a wider density"


def failure(
    result: Evolved | None, model: FibreModel, work: Work, tolerance: float
) -> ToleranceError:
    """How far the best result is from the tolerance, and what would help."""
    reached = math.inf if result is None else excess(result) * tolerance
    helps = "" if result is None else remedy(result)
    if work.required:
        helps = (
            f"at noise {model.noise:g} it takes work of {work.required:.2g} or more, "
            f"where {work.allowed:.2g} is allowed: ask for earlier `s`, enlarge "
            "`tolerance`, raise `work_limit` or use `solve`"
        )
    return ToleranceError(reached, tolerance, helps)
