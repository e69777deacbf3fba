"""The gap and the variance of smooth fibres against what they are at R = 0."""

from __future__ import annotations

from functools import lru_cache

from fpsolve.model.laydown import LayDownModel
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.spectral.bases.weights import quadratic
from fpsolve.spectral.eigen.gap import SpectralGap, spectral_gap
from fpsolve.spectral.evolution.steady import spectral_steady_state
from fpsolve.studies.constants.relaxation_slopes import (
    Slope,
    gap_slope,
    variance_slope,
)

__all__ = ["gap_case", "variance_case"]

# Relative accuracy of the gap; of moments, which cost less.
_GAP_TOLERANCE, _TOLERANCE = 1e-6, 1e-7
Numbers = dict[str, float]


def gap_case(model: SmoothLayDownModel) -> Numbers:
    """|gap − gap_0|, and what is left of it after R times the derivative at R = 0."""
    gap = spectral_gap(model, tolerance=_GAP_TOLERANCE)
    limit, slope = _gap_of(model.white_noise_limit)
    change, error = float(gap) - float(limit), gap.error + limit.error
    return {
        "gap": abs(change), "gap_error": error, "value": float(gap),
        **_left(change, error, model.relaxation_length, slope),
    }  # fmt: skip


def variance_case(model: SmoothLayDownModel) -> Numbers:
    """|Var ξ₁ − σ²|, and what is left of it after R times the derivative at R = 0."""
    found = spectral_steady_state(model, tolerance=_TOLERANCE)
    variance, error = found.moments["variance_xi1"], found.errors["variance_xi1"]
    change = variance - quadratic(model).sigma1 ** 2
    slope = _variance_slope_of(model.white_noise_limit)
    return {
        "variance": abs(change), "variance_error": error, "value": variance,
        **_left(change, error, model.relaxation_length, slope),
    }  # fmt: skip


def _left(change: float, error: float, length: float, slope: Slope) -> Numbers:
    return {
        "next_term": abs(change - length * float(slope)),
        "next_term_error": error + length * slope.error,
    }


# The same for every R of a study.
@lru_cache(maxsize=1)
def _gap_of(limit: LayDownModel) -> tuple[SpectralGap, Slope]:
    return spectral_gap(limit), gap_slope(limit)


@lru_cache(maxsize=1)
def _variance_slope_of(limit: LayDownModel) -> Slope:
    return variance_slope(limit)
