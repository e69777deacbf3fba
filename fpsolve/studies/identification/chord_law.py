"""The Gaussian law of a chord: exact over a step, for a smooth fibre or a basic one.

A smooth fibre between two nodes is the linear equation dα = κ ds,
dκ = (f - κ)/R ds + K dW with a force that changes linearly; (κ, α, ∫α) is Gaussian
with the covariance K² ∫ g gᵀ du. R → 0 at fixed A = RK is the basic model, whose mean
angles over successive steps h have increments of variance (2/3)A²h and correlation 1/4.

The angle of a chord is not the mean of α along it but arg ∫ e^{iα} du
= ᾱ - ⟨(α - ᾱ)³⟩/6 + …; to first order in V = E⟨(α - ᾱ)²⟩ this changes the covariance
of the angles as a white noise of variance V²/10 would.
"""

from __future__ import annotations

from dataclasses import dataclass

from fpsolve._kernels.chord_filter import ChordLaw
from fpsolve.paths.smooth_step import phi, smooth_step

__all__ = ["Parameters", "chord_law"]

Three = tuple[float, float, float]
Six = tuple[float, float, float, float, float, float]
# Factors of κ, weights of the force, covariance, and the variance of α about its mean.
Step = tuple[Three, Six, Six, float]


@dataclass(frozen=True)
class Parameters:
    """What a likelihood is a function of.

    Attributes
    ----------
    strength : (float, float)
        (1/σ1², 1/σ2²), of either sign.
    noise : float
        A.
    relaxation_length : float
        R; 0 for the basic model.
    """

    strength: tuple[float, float]
    noise: float
    relaxation_length: float = 0.0


def chord_law(at: Parameters, ds: float, position_error: float = 0.0) -> ChordLaw:
    """Weights and noise of a chord of length `ds`."""
    if at.relaxation_length:
        kappa, weights, noise, spread = _smooth(at, ds)
        # E κ² = K²R/2 + E cos²α/σ1² + E sin²α/σ2² - v²/σ1² of a stationary fibre.
        bent = 0.5 * at.noise**2 / at.relaxation_length + max(0.0, *at.strength)
    else:
        kappa, weights, noise, spread = _basic(at.noise, ds)
        bent = 0.0
    return ChordLaw(
        kappa=kappa,
        weights=weights,
        noise=noise,
        chord_variance=0.1 * spread**2,
        position_variance=position_error**2,
        curvature_variance=bent,
        strength=at.strength,
    )


def _basic(noise: float, h: float) -> Step:
    """α and its mean over the step; the curvature that is known is the force."""
    variance = noise**2 * h
    covariance = (0.0, 0.0, variance, 0.0, variance / 2, variance / 3)
    return (0.0, 0.0, 0.0), (1.0, 0.5, h, 0.0, h / 2, -h / 12), covariance, variance / 6


def _smooth(at: Parameters, h: float) -> Step:
    """κ, α and the mean of α over the step."""
    x = h / at.relaxation_length
    p0, p1, p2, p3, p4 = (float(phi(k, x)) for k in range(5))
    step = smooth_step(at.relaxation_length, at.noise, h)
    n11, n21, n22, n31, n32, n33 = step.noise
    covariance = (
        n11**2, n21 * n11, n21**2 + n22**2,
        n31 * n11, n31 * n21 + n32 * n22, n31**2 + n32**2 + n33**2,
    )  # fmt: skip
    weights = (
        x * p1, x * (p2 - p1 / 2),
        h * x * p2, h * x * (p3 - p2 / 2),
        h * x * p3, h * x * (p4 - p3 / 2),
    )  # fmt: skip
    return (p0, h * p1, h * p2), weights, covariance, 2 * step.spread[0]
