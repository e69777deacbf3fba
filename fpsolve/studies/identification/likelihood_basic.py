"""Parameters of the basic model from a fibre curve, by maximum likelihood."""

from __future__ import annotations

import math

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.paths.fibres.fibre_curve import FibreCurve
from fpsolve.studies.identification.estimate import Estimate
from fpsolve.studies.identification.from_maximum import estimate_of
from fpsolve.studies.identification.likelihood import Likelihood
from fpsolve.studies.identification.maximum import Maximum, maximum
from fpsolve.studies.identification.whitened import least_squares

__all__ = ["basic_maximum", "estimate_basic"]


def estimate_basic(curve: FibreCurve) -> Estimate:
    """(σ1, σ2, A) that make the chords of a fibre most likely.

    The angles of chords over Δs are means of α: with the force known, their increments
    are Gaussian with variance (2/3)A²Δs and correlation 1/4, a moving average whose
    likelihood a Kalman filter gives exactly. The force is read off the fibre, and that
    it contains the noise of its own chord is accounted for by the Jacobian.

    The covariance is the inverse curvature of the likelihood in (1/σ1², 1/σ2², ln A).
    Where turns from chord to chord may cost more than half a standard error of A or K,
    it holds that too, and `notes` say so.

    Parameters
    ----------
    curve : FibreCurve
        With its reference curve.

    Returns
    -------
    Estimate

    Raises
    ------
    ValueError
        If the reference curve is not known, the angles cannot be unwrapped, or the
        fibre does not show that it is drawn back.
    ToleranceError
        If no maximum is found.

    References
    ----------
    [KMW09]_, section 4.1; [Kal60]_ and [Schw65]_, for the filter and its
    likelihood.
    """
    found = basic_maximum(Likelihood.of(curve))
    return estimate_of(curve, found, found.covariance(), {})


def basic_maximum(likelihood: Likelihood) -> Maximum:
    """The largest likelihood in (1/σ1², 1/σ2², ln A)."""
    start = least_squares(likelihood, 0.0)
    at = np.array([*start.strength, math.log(start.noise)])
    return maximum(likelihood, at, expected_errors(likelihood, start.noise)[:3])


def expected_errors(likelihood: Likelihood, noise: float) -> Array:
    """About the standard errors of (1/σ1², 1/σ2², ln A, ln R).

    The first two are A over the root of ∫ f² ds, f the force of 1/σ² = 1; the third is
    that of a variance of n Gaussian numbers.
    """
    forces = np.concatenate([chords.forces for chords in likelihood.fibres])
    squares = likelihood.ds * (forces**2).sum(axis=0)
    n = likelihood.n_angles
    return np.array([*noise / np.sqrt(squares), (2 * n) ** -0.5, 3 * n**-0.5])
