"""Which parameters the curve does not determine, or not as its errors say, and why."""

from __future__ import annotations

import math

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.paths.fibres.fibre_curve import FibreCurve

__all__ = [
    "check_confined",
    "chord_bias",
    "coarse_points",
    "loose_noise",
    "loose_strengths",
    "with_chord_bias",
]

# 1/σ² within so many standard errors of zero is no confinement.
_DEVIATIONS = 2.0
# Relative standard error beyond which a parameter is known to a factor only.
_LOOSE = 0.5
# A and K err relatively by less than this times (κ_rms Δs)², for what the law of chords
# leaves out; said where that is more than so many standard errors. Measured at A = 10:
# docs/identification_likelihood.md.
_CHORD_BIAS, _SHARE_OF_ERROR = 0.007, 0.5


def check_confined(strength: Array, errors: Array, length: float) -> None:
    """Raise ValueError unless both 1/σ² are positive: there is no model without."""
    for number, (value, error) in enumerate(zip(strength, errors, strict=True), 1):
        if not value > 0:
            raise ValueError(
                f"`curve` must show that the fibre is drawn back in direction {number},"
                f" got 1/sigma{number}² = {value:.3g} ± {error:.2g} from a length of "
                f"{length:.4g}; take a longer fibre, or several, and see that `curve` "
                "has the right reference curve."
            )


def loose_strengths(strength: Array, errors: Array, length: float) -> dict[str, str]:
    """The throwing ranges that might as well be infinite."""
    found = {}
    for number, (value, error) in enumerate(zip(strength, errors, strict=True), 1):
        if not value > _DEVIATIONS * error:
            needed = length * (2 * _DEVIATIONS * error / value) ** 2
            found[f"sigma{number}"] = (
                f"1/σ{number}² = {value:.3g} ± {error:.2g} is not told from 0: over a "
                f"length of {length:.4g} the noise turns the fibre more than the force "
                f"does; about {needed:.2g} are needed"
            )
    return found


def loose_noise(
    relaxation_length: float, covariance: Array, gain: float, ds: float
) -> dict[str, str]:
    """Of A and K of a smooth fibre those that are known to a factor only.

    Parameters
    ----------
    relaxation_length : float
        R.
    covariance : ndarray, shape (2, 2)
        Of (ln A, ln R).
    gain : float
        By how much ln p exceeds that of R = 0.
    ds : float
    """
    errors = {
        "noise": math.sqrt(covariance[0, 0]),
        "curvature_noise": math.sqrt(float(np.array([1, -1]) @ covariance @ [1, -1])),
    }
    if not gain > 0.5 * _DEVIATIONS**2:
        return {
            "curvature_noise": f"R = {relaxation_length:.3g} fits better than R = 0 "
            f"by {max(gain, 0.0):.2g} in ln L only: the curvature relaxes "
            f"within the distance {ds:.3g} of the points; take points closer together, "
            'or model="basic"'
        }
    return {
        name: f"its relative standard error is {error:.2g}: the relaxation length "
        f"R = {relaxation_length:.3g} is known to a factor only, so that one of A and "
        "K = A/R is; take a longer fibre"
        for name, error in errors.items()
        if not error < _LOOSE
    }


def coarse_points(curve: FibreCurve, covariance: Array) -> tuple[str, ...]:
    """A note where the distance of the points costs more than the errors say.

    Parameters
    ----------
    curve : FibreCurve
    covariance : ndarray
        Of (1/σ1², 1/σ2², ln A) or (1/σ1², 1/σ2², ln A, ln R).
    """
    square, bias = chord_bias(curve)
    variances = {"noise": covariance[2, 2]}
    if len(covariance) == 4:
        of_both = np.array([1.0, -1.0])
        variances["curvature_noise"] = of_both @ covariance[2:, 2:] @ of_both
    # Nothing is said of an infinite variance.
    names = [
        name
        for name, variance in variances.items()
        if bias > _SHARE_OF_ERROR * math.sqrt(max(0.0, variance))
    ]
    if not names:
        return ()
    return (
        f"the fibre turns by κ_rms Δs = {math.sqrt(square):.2g} from chord to chord, "
        f"which may change {' and '.join(names)} by up to {100 * bias:.2g} %: the "
        "standard errors are that much larger; take points closer together than "
        f"{curve.ds:.3g}",
    )


def with_chord_bias(curve: FibreCurve, covariance: Array) -> Array:
    """The covariance with the square of what ln A, and with it ln K, may err by."""
    widened = covariance.copy()
    widened[2, 2] += chord_bias(curve)[1] ** 2
    return widened


def chord_bias(curve: FibreCurve) -> tuple[float, float]:
    """(κ_rms Δs)² of the fibre, and by what share A and K may err for it."""
    # Errors of points turn chords by a variance of 6 (error/Δs)², which is known.
    scattered = 6 * (curve.position_error / curve.ds) ** 2
    square = max(0.0, curve.check_turns() ** 2 - scattered)
    return square, _CHORD_BIAS * square
