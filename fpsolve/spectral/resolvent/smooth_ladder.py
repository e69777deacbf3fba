"""Truncations of a smooth fibre of growing size, and its stationary law in them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.errors import ToleranceError
from fpsolve.model.persistence import Persistence
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.spectral.bases.placement import (
    NARROWEST,
    Placement,
    first_placement,
    throwing_ranges,
)
from fpsolve.spectral.resolvent.centre import centre_of
from fpsolve.spectral.resolvent.ladder import Ladder, grown
from fpsolve.spectral.resolvent.smooth_basis import SmoothBasis
from fpsolve.spectral.resolvent.smooth_generator import SmoothGenerator
from fpsolve.spectral.resolvent.smooth_limit import smooth_angle_density
from fpsolve.spectral.resolvent.smooth_waves import (
    angle_moments,
    characteristic,
    position_variances,
)

__all__ = ["SmoothLadder", "settled"]

# Of the smallest truncation in ξ and α; that in κ follows.
DEGREE, HARMONICS = 8, 5
# Of the variances of ξ those of the weight, where they are larger than the placement of
# the stationary density has them: plane waves need wider ones than moments do.
SHARE = 2.0 / 3.0
# A weight that has moved less, in units of its width, is where it should be; how often
# it may move.
SETTLED, MOVES = 0.02, 12
# What the stationary law of predictions may be wrong by, where its error is told.
LAW = 2e-3
# States of its largest truncation, of which half are factorised, as real numbers.
MOST_LAW = 40_000
# Where the law is told, for its error: directions, and wave numbers of its widths.
DIRECTIONS, WAVES = np.linspace(0.0, math.pi, 5), (0.5, 1.0, 2.0)


@dataclass(eq=False)
class SmoothLadder(Ladder):
    """Generators of a smooth model in bases of growing size.

    Attributes
    ----------
    model : SmoothLayDownModel
    placement : Placement
        Of all bases.
    spreads : (float, float)
        Deviations of ξ1 and ξ2, as the smallest truncation knows them.
    """

    # Three truncations: with two directions more one change may be small by chance.
    unseen: ClassVar[float] = math.inf

    model: SmoothLayDownModel  # type: ignore[assignment]
    placement: Placement = field(init=False)
    spreads: tuple[float, float] = field(init=False)
    _laws: list[SmoothGenerator] = field(default_factory=list, init=False)
    _known: float = field(default=math.inf, init=False)

    def __post_init__(self) -> None:
        self.placement, variances = settled(self.model, self.first)
        known = [
            max(variance, NARROWEST * sigma**2)
            for variance, sigma in zip(variances, self.scales, strict=True)
        ]
        self.spreads = math.sqrt(known[0]), math.sqrt(known[1])
        widths = [
            max(width, math.sqrt(SHARE) * spread)
            for width, spread in zip(self.placement.widths, self.spreads, strict=True)
        ]
        self.placement = replace(self.placement, widths=(widths[0], widths[1]))
        self.centre = self.placement.centre

    @property
    def first(self) -> SmoothBasis:
        """The smallest truncation."""
        return self.basis(DEGREE, HARMONICS)

    def basis(self, degree: int, harmonics: int) -> SmoothBasis:
        """With the degree in κ that one in ξ deserves, of `CoupledDiscretisation`."""
        a = Persistence.of(self.model).bending
        share = 0.8 + (a + 4.0 * math.sqrt(a)) / 35.0
        return SmoothBasis(degree, harmonics, math.ceil(share * degree))

    def generator(  # type: ignore[override]
        self, basis: SmoothBasis
    ) -> SmoothGenerator:
        """The generator in a basis."""
        kept: dict[Any, Any] = self._kept
        if basis not in kept:
            kept[basis] = SmoothGenerator(self.model, self.placement, basis)
        found: SmoothGenerator = kept[basis]
        return found

    def laws(self, tolerance: float) -> list[SmoothGenerator]:
        """Two truncations whose stationary laws differ by less than a tolerance.

        The finer one first. Compared are densities of the angle and characteristic
        functions of ξ. What was good enough before is not computed again.

        Raises
        ------
        ToleranceError
            If the largest ones differ by more.
        """

        def told(generator: SmoothGenerator) -> Array:
            angle = 2 * math.pi * smooth_angle_density(generator, DIRECTIONS)
            width1, width2 = self.placement.widths
            waves = [(q / width1, 0.0) for q in WAVES]
            waves += [(0.0, q / width2) for q in WAVES]
            found = [abs(characteristic(generator, k)) for k in waves]
            return np.concatenate([angle, found])

        if not tolerance >= self._known:
            _, _, level = self.climb(
                self.first, told, lambda found: np.full(found.shape, tolerance),
                most=MOST_LAW,
            )  # fmt: skip
            self._known, self._laws = tolerance, [
                self.generator(grown(self.first, one)) for one in (level, level - 1)
            ]  # fmt: skip
        return self._laws

    def characteristics(self, k2: Array) -> tuple[Array, Array]:
        """E e^{i k2 ξ2} in two truncations, the finer one first."""
        fine, coarse = (
            np.array([characteristic(law, (0.0, k)).real for k in k2.tolist()])
            for law in self.laws(LAW)
        )
        return fine, coarse

    def double_cosines(self) -> tuple[float, float]:
        """E cos 2α in two truncations, the finer one first."""
        fine, coarse = (float(angle_moments(law, 0)[2]) for law in self.laws(LAW))
        return fine, coarse


def settled(
    model: SmoothLayDownModel, basis: SmoothBasis
) -> tuple[Placement, tuple[float, float]]:
    """The placement about the stationary law, and the variances of ξ.

    From the mean of the basic model, moved to the moments of a small truncation until
    they stay.

    Raises
    ------
    ToleranceError
        If they do not.
    """
    place = replace(first_placement(model), centre=centre_of(model.white_noise_limit))
    distance = math.inf
    for _ in range(MOVES):
        generator = SmoothGenerator(model, place, basis)
        mean, along, across = position_variances(generator)
        moved = place.about(mean, (along, across), throwing_ranges(model))
        distance, place = place.distance(moved), moved
        if distance < SETTLED:
            return place, (along, across)
    remedy = "choose a slower belt or a larger noise: no basis stays about the mean"
    raise ToleranceError(distance, SETTLED, remedy)
