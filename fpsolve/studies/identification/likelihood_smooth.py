"""Parameters of the smooth model from a fibre curve, by maximum likelihood."""

from __future__ import annotations

import math

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.paths.fibres.fibre_curve import FibreCurve
from fpsolve.studies.identification.determined import loose_noise
from fpsolve.studies.identification.estimate import Estimate
from fpsolve.studies.identification.from_maximum import estimate_of
from fpsolve.studies.identification.likelihood import Likelihood
from fpsolve.studies.identification.likelihood_basic import (
    basic_maximum,
    expected_errors,
)
from fpsolve.studies.identification.maximum import Maximum, maximum
from fpsolve.studies.identification.whitened import least_squares

__all__ = ["estimate_smooth", "smooth_maximum"]

# Relaxation lengths from which the search may start, as multiples of Δs.
_LENGTHS = 2.0 ** np.arange(-1, 9)


def estimate_smooth(curve: FibreCurve) -> Estimate:
    """(σ1, σ2, A, K) that make the chords of a fibre most likely.

    A Kalman filter with the exact Gaussian law of (κ, α, ∫α) over Δs for a force that
    changes linearly, which is read off the fibre; see `estimate_basic`. The error of
    the points, which makes neighbouring chords err in opposite ways, is part of the
    state. Likelihoods are of the same angles as those of the basic model, R = 0, and
    can be compared with them.

    Parameters
    ----------
    curve : FibreCurve
        With its reference curve.

    Returns
    -------
    Estimate
        Where R is not told from 0, K has an infinite variance, and the others are those
        for the R that is found.

    Raises
    ------
    ValueError
        If the reference curve is not known, the angles cannot be unwrapped, or the
        fibre does not show that it is drawn back.
    ToleranceError
        If no maximum is found.

    References
    ----------
    [KMW09]_, sections 3.2 and 4.1; [Kal60]_ and [Schw65]_, for the filter and its
    likelihood.
    """
    likelihood = Likelihood.of(curve)
    found = smooth_maximum(likelihood)
    covariance = found.covariance(may_fail=3)
    gain = found.value - basic_maximum(likelihood).value
    length = math.exp(found.at[3])
    open_ = loose_noise(length, covariance[2:, 2:], gain, likelihood.ds)
    return estimate_of(curve, found, covariance, open_)


def smooth_maximum(likelihood: Likelihood) -> Maximum:
    """The largest likelihood in (1/σ1², 1/σ2², ln A, ln R).

    Where a filter of trial has no digits left, as of a force that grows without bound
    along a fibre that goes far, the search does not start.
    """
    starts = [_start(likelihood, likelihood.ds * x) for x in _LENGTHS]
    finite = [start for start in starts if np.isfinite(start).all()]
    if not finite:
        raise ValueError(
            "`curve` must stay near its reference curve, but the filter of no "
            "relaxation length has digits left along it; see that `curve` is the right "
            "one, and that points are not too far apart."
        )
    at = max(finite, key=likelihood)
    scale = expected_errors(likelihood, math.exp(at[2]))
    return maximum(likelihood, at, scale)


def _start(likelihood: Likelihood, relaxation_length: float) -> Array:
    """Least squares for a given R; NaN if there are none."""
    at = least_squares(likelihood, relaxation_length)
    return np.array([*at.strength, math.log(at.noise), math.log(relaxation_length)])
