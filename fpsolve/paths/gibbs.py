"""Points of the plane with the density exp(-B)/Z."""

from __future__ import annotations

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.model.potentials.linear import LinearPotential
from fpsolve.model.potentials.potential import Potential
from fpsolve.model.potentials.power import PowerPotential
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.paths.patches import PatchRejection

__all__ = ["GibbsSampler"]


# Share of exp(-B) beyond every place that is sampled which no sample can show.
NEGLIGIBLE = 1e-10


class GibbsSampler:
    """Draws ξ from exp(-B)/Z: exactly for powers of ‖ξ‖, else by rejection.

    Parameters
    ----------
    potential : Potential

    Raises
    ------
    ValueError
        If exp(-B) has no finite integral, or falls too slowly.
    """

    def __init__(self, potential: Potential) -> None:
        if not potential.normalisable:
            raise ValueError(
                f"`potential` must confine, got {potential!r}: exp(-B) has no finite "
                "integral."
            )
        self.potential = potential
        self.power = as_power(potential)
        quadratic = type(potential) is QuadraticPotential
        if not quadratic and self.power is None:
            self.rejection = plane_rejection(potential)

    def __call__(self, rng: np.random.Generator, n: int) -> Array:
        """Draw n points, shape (n, 2)."""
        if type(self.potential) is QuadraticPotential:
            ranges = self.potential.sigma1, self.potential.sigma2
            return np.asarray(rng.standard_normal((n, 2)) * ranges)
        if self.power is not None:
            return isotropic_power(rng, n, *self.power)
        return self.rejection(rng, n)


def as_power(potential: Potential) -> tuple[float, float] | None:
    """Exponent n and scale c if B = (‖ξ‖/c)ⁿ/n."""
    if type(potential) is LinearPotential:
        return 1.0, 1.0 / potential.slope
    if type(potential) is PowerPotential:
        return potential.exponent, potential.scale
    return None


def isotropic_power(
    rng: np.random.Generator, n: int, exponent: float, scale: float
) -> Array:
    """r from r exp(-(r/c)ⁿ/n): (r/c)ⁿ/n has the gamma law of shape 2/n."""
    energy = rng.gamma(2.0 / exponent, size=n)
    radius = scale * (exponent * energy) ** (1.0 / exponent)
    direction = rng.uniform(0.0, 2.0 * np.pi, n)
    away = np.stack([np.cos(direction), np.sin(direction)], axis=1)
    points: Array = radius[:, None] * away
    return points


def plane_rejection(potential: Potential) -> PatchRejection:
    """Rejection from exp(-B) on the cells that resolve it, wherever they lie."""
    normalisation = potential.resolved_normalisation
    if not normalisation.tail <= NEGLIGIBLE:
        raise ValueError(
            f"`potential` must grow fast enough to be sampled, got {potential!r}: a "
            f"share of {normalisation.tail:.2g} of exp(-B) lies farther out than "
            "floats resolve its valleys."
        )
    return PatchRejection(potential.value, normalisation, potential.isotropic)
