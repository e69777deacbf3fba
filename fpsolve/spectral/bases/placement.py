"""Where the Gaussian weight of a basis stands in the plane, and how wide it is."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.spectral.bases.weights import (
    Weight,
    curvature_weight,
    position_weight,
    quadratic,
)

__all__ = [
    "Placement",
    "belt_speed",
    "first_placement",
    "is_round",
    "throwing_ranges",
]

# Variance of the weight for that of the density, in its long tails; measured.
SHARE = 0.44
# Variances of a truncation that is too coarse may be negative.
NARROWEST = 0.05


@dataclass(frozen=True)
class Placement:
    """A Gaussian of positions about (centre, 0), w^ϑ of it for densities; one of κ.

    On a belt the density stands off the origin, and is wider along the belt than
    across: in coordinates x1 = (ξ1 - centre)/S1 and x2 = ξ2/S2 it is nearly round.

    Parameters
    ----------
    centre : float
        Near E ξ1.
    widths : (float, float)
        S1 and S2.
    exponent : float
        ϑ of positions, as in `Weight`.
    curvature : Weight
        Weight of κ.
    """

    centre: float
    widths: tuple[float, float]
    exponent: float
    curvature: Weight

    @property
    def round(self) -> Weight:
        """The weight in the coordinates x1 and x2."""
        return Weight(1.0, self.exponent)

    def about(
        self,
        mean: float,
        variances: tuple[float, float],
        sigmas: tuple[float, float],
    ) -> Placement:
        """The same about a density with this mean of ξ1 and these variances of ξ.

        In each direction half the variance, but a Gaussian of the throwing range where
        that is wider and the density as wide as it.
        """
        widths = []
        for sigma, variance in zip(sigmas, variances, strict=True):
            known = max(variance, NARROWEST * sigma**2)
            least = min(sigma**2, self.exponent * known)
            widths.append(math.sqrt(max(SHARE * known, least)))
        return replace(self, centre=mean, widths=(widths[0], widths[1]))

    def distance(self, other: Placement) -> float:
        """Largest move of the centre in widths, or change of a width as a share."""
        moved = abs(other.centre - self.centre) / self.widths[0]
        pairs = zip(self.widths, other.widths, strict=True)
        return max(moved, *(abs(new / old - 1.0) for old, new in pairs))


def first_placement(model: SmoothLayDownModel) -> Placement:
    """That of the isotropic model with the mean stiffness, as wide as each direction.

    (1/σ1² + 1/σ2²)/2 = 1/σ² is what the fibre sees of B when it turns fast.
    """
    sigma1, sigma2 = throwing_ranges(model)
    sigma = mean_range(model)
    similar = SmoothLayDownModel(
        QuadraticPotential(sigma), model.relaxation_length, model.noise
    )
    weight = position_weight(similar)
    ratio = math.sqrt(weight.variance) / sigma
    widths = (ratio * sigma1, ratio * sigma2)
    return Placement(0.0, widths, weight.exponent, curvature_weight(similar))


def mean_range(model: SmoothLayDownModel) -> float:
    """σ with 1/σ² = (1/σ1² + 1/σ2²)/2."""
    sigma1, sigma2 = throwing_ranges(model)
    return math.sqrt(2.0) / math.hypot(1.0 / sigma1, 1.0 / sigma2)


def throwing_ranges(model: SmoothLayDownModel) -> tuple[float, float]:
    """σ1 and σ2; ValueError unless the potential is quadratic."""
    potential = quadratic(model)
    return potential.sigma1, potential.sigma2


def is_round(model: SmoothLayDownModel) -> bool:
    """Whether no direction of the plane is distinguished."""
    return bool(model.potential.isotropic and model.curve.fixed)


def belt_speed(model: SmoothLayDownModel) -> float:
    """v of a belt at rest or at constant speed."""
    return -float(model.curve.velocity(0.0)[0]) + 0.0
