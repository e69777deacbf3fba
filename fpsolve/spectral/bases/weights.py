"""Gaussian weights of a smooth fibre, shared between trial and test functions."""

from __future__ import annotations

from dataclasses import dataclass

from scipy.special import hyp1f1

from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.model.smooth import SmoothLayDownModel

__all__ = ["Weight", "curvature_weight", "position_weight"]


@dataclass(frozen=True)
class Weight:
    """w^ϑ He_n for densities against w^{1-ϑ} He_n for observables, w a Gaussian.

    He_n are the orthonormal polynomials of w, so that both families are dual to each
    other for every ϑ. With ϑ < 1 densities may have wider tails than w.

    Parameters
    ----------
    variance : float
        That of w, in every direction.
    exponent : float
        ϑ of densities, 1/2 < ϑ <= 1.
    """

    variance: float
    exponent: float


def position_weight(model: SmoothLayDownModel) -> Weight:
    """Weight in ξ of a quadratic potential, in units of which throwing range σ1 = 1.

    The tail of the stationary density is exponential rather than Gaussian, by a length
    that grows with R/σ1: ϑ falls with it. The variance is a little less than half that
    of the limit of large noise, ₁F₁(1; a+1; a) σ1² with a = A²R/2, and of the density
    at little noise.

    Measured, not derived: with ϑ = 1 expansions diverge for R of about σ1/2 and more.
    """
    sigma = quadratic(model).sigma1
    length, a = model.relaxation_length / sigma, 0.5 * loudness(model)
    wide = 0.4 * (float(hyp1f1(1.0, a + 1.0, a)) + length)
    return Weight(sigma**2 * max(1.0, wide), 1.0 - 0.35 * length / (length + 0.1))


def curvature_weight(model: SmoothLayDownModel) -> Weight:
    """Weight in κ: that of a free fibre, A²/(2R), and ϑ < 1 where the force adds to it.

    Without noise the curvature is that of the force, of the order of 1/σ1; hence the
    least variance. Measured, not derived.
    """
    sigma = quadratic(model).sigma1
    variance = model.curvature_variance
    exponent = 1.0 - 0.4 / (1.0 + 0.5 * sigma**2 * variance)
    return Weight(max(variance, 0.2 / sigma**2), exponent)


def loudness(model: SmoothLayDownModel) -> float:
    """A²R = K²R³: twice the a of the limit of large noise."""
    return model.noise**2 * model.relaxation_length


def quadratic(model: SmoothLayDownModel) -> QuadraticPotential:
    """The potential; ValueError unless it is quadratic."""
    if not isinstance(model.potential, QuadraticPotential):
        raise ValueError(
            "`potential` must be a QuadraticPotential for the spectrum of a smooth "
            f"fibre, got {model.potential!r}; for others fit the decay of a run of "
            "`solve`."
        )
    return model.potential
