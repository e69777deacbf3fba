"""Which basis serves a model: products of polynomials, or radial functions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fpsolve._support.arrays import Array
from fpsolve.model import laydown
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.spectral.bases.radial_basis import smooth_in_square
from fpsolve.spectral.evolution.quadratic import check_noise_and_belt
from fpsolve.spectral.resolvent.basis import Basis
from fpsolve.spectral.resolvent.generator import Generator
from fpsolve.spectral.resolvent.ladder import Allowed, Ladder
from fpsolve.spectral.resolvent.round_basis import RoundBasis
from fpsolve.spectral.resolvent.round_generator import RoundGenerator
from fpsolve.spectral.resolvent.round_waves import of_round, times_round

__all__ = ["RoundLadder", "check_spectrum_model"]

# 3 s for one short wave under B = r⁴/4 with 10 000.
MOST_STATES = 12_000
# What `plane_wave` and `multiplied` call for a `RoundGenerator`.
WAVES = of_round, times_round


class RoundLadder(Ladder):
    """Generators of an isotropic smooth potential in bases of growing size."""

    def __post_init__(self) -> None:
        self.centre = 0.0

    @property
    def scales(self) -> tuple[float, float]:
        """Root mean squares of ξ1 and of ξ2 at rest."""
        return self.generator(Basis(0, 1)).scales

    def climb(
        self,
        first: Basis,
        compute: Callable[[Generator], Array],
        allowed: Allowed,
        level: int = 0,
        most: int = MOST_STATES,
        unseen: float | None = None,
    ) -> tuple[Array, Array, int]:
        """As `Ladder.climb`, to fewer states: a steeper force fills the factors."""
        fewest = min(most, MOST_STATES)
        return super().climb(first, compute, allowed, level, fewest, unseen)

    def generator(self, basis: Basis) -> Generator:
        """The generator in as many radial functions."""
        if basis not in self._kept:
            own = RoundBasis(basis.degree, basis.harmonics)
            self._kept[basis] = RoundGenerator(self.model, own, self.centre)
        return self._kept[basis]


def check_spectrum_model(model: Any) -> None:
    """Raise unless the resolvent of the model is known in one of the bases.

    Raises
    ------
    TypeError
        If it is no `LayDownModel`.
    ValueError
        If the potential is neither quadratic nor isotropic, does not confine or has a
        kink, the noise is not positive, or the curve is no belt.
    """
    laydown.check_model(model)
    potential = model.potential
    if not isinstance(potential, QuadraticPotential):
        if not potential.isotropic:
            raise ValueError(
                f"`potential` must be quadratic or isotropic, got {potential!r}; of "
                "others there is no basis, count on webs of `lay_web`."
            )
        if not potential.normalisable:
            raise ValueError(
                f"`potential` must confine, got {potential!r}: exp(-B) has no finite "
                "integral."
            )
        if not smooth_in_square(potential):
            raise ValueError(
                f"`potential` must be a smooth function of ‖ξ‖², got {potential!r}; "
                "plane waves converge slowly in functions with a kink, count on webs "
                "of `lay_web`."
            )
    check_noise_and_belt(model)
