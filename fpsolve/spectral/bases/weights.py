"""Gaussian weights of a smooth fibre, shared between trial and test functions."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fpsolve.model.persistence import Persistence
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.model.smooth import SmoothLayDownModel

__all__ = [
    "Weight",
    "curvature_weight",
    "position_weight",
    "quadratic",
]


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
    that grows with R/σ1 and falls with the noise: ϑ is the smaller. In the limit of
    large noise the density is Gaussian, of variance ₁F₁(1; a+1; a) σ1² with a = A²R/2,
    of which w takes a share; at little noise its orbits are resolved by a narrow w.

    Measured, not derived: with ϑ = 1 expansions diverge for R of about σ1/2 and more,
    and of the rules that were tried this one takes the fewest functions.
    """
    sigma = quadratic(model).sigma1
    length, noise = model.relaxation_length / sigma, model.noise * math.sqrt(sigma)
    softness = length / (length + 0.1 * (1.0 + 0.5 * noise**2))
    exponent = 1.0 - 0.35 * softness
    narrow = min(1.0, 0.78 * noise**0.6)
    wide = (exponent - 0.25) * (Persistence.of(model).factor + length)
    return Weight(sigma**2 * max(narrow, wide), exponent)


def curvature_weight(model: SmoothLayDownModel) -> Weight:
    """Weight in κ: less than that of a free fibre, A²/(2R), which the force narrows.

    Without noise the curvature is that of the force, of the order of 1/σ1; hence the
    least variance, and ϑ < 1 where it counts. Measured, not derived.
    """
    sigma = quadratic(model).sigma1
    free = sigma**2 * model.curvature_variance
    variance = max(0.65 * free, min(free, 1.7), 0.2)
    return Weight(variance / sigma**2, 1.0 - 0.4 / (1.0 + free / 8.0))


def quadratic(model: SmoothLayDownModel) -> QuadraticPotential:
    """The potential; ValueError unless it is quadratic."""
    if not isinstance(model.potential, QuadraticPotential):
        raise ValueError(
            "`potential` must be a QuadraticPotential for the spectrum of a smooth "
            f"fibre, got {model.potential!r}; for others fit the decay of a run of "
            "`solve`."
        )
    return model.potential
