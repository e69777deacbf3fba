"""Truncations of growing size of the law under a moving nozzle."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array, Complex
from fpsolve.model.laydown import LayDownModel
from fpsolve.spectral.evolution.quadratic import quadratic
from fpsolve.spectral.resolvent.basis import Basis
from fpsolve.spectral.resolvent.centre import centre_of
from fpsolve.spectral.resolvent.ladder import Ladder
from fpsolve.spectral.resolvent.nozzle_generator import (
    NozzleBasis,
    NozzleGenerator,
    Swing,
    on_belt,
)
from fpsolve.spectral.resolvent.nozzle_law import NozzleLaw

__all__ = ["NozzleLadder"]

# What knows the mean well enough for a centre, and how often that is moved there.
SMALL, TIMES = NozzleBasis(Basis(8, 6), 3), 2
FIRST = NozzleBasis(Basis(10, 7), 4)
# Unknowns of the largest truncation: minutes, and gigabytes of factors.
MOST_UNKNOWNS = 100_000


@dataclass(eq=False)
class NozzleLadder(Ladder):
    """Laws of a model with a moving nozzle in bases of growing size.

    Attributes
    ----------
    model : LayDownModel
    swing : Swing
        Where all bases are centred.
    """

    swing: Swing = field(init=False)
    _laws: dict[NozzleBasis, NozzleLaw] = field(default_factory=dict, init=False)

    def __post_init__(self) -> None:
        self.centre = centre_of(on_belt(self.model))
        self.swing = swing_of(self.model, self.centre)

    def generator(self, basis: Any) -> Any:
        """The law in a basis."""
        if basis not in self._laws:
            made = NozzleGenerator(self.model, basis, self.swing)
            self._laws[basis] = NozzleLaw(made)
        return self._laws[basis]

    def expectations(
        self, compute: Callable[[NozzleLaw], Complex], allowed: Callable[[Any], Array]
    ) -> tuple[Complex, Array]:
        """What `compute` makes of the law, and bounds of the errors; see `climb`."""
        asked: Any = compute
        found, errors, _ = self.climb(FIRST, asked, allowed, 0, MOST_UNKNOWNS)
        return found.astype(np.complex128), errors


def swing_of(model: LayDownModel, centre: float) -> Swing:
    """E ξ(s), its mean and first harmonic, as small truncations know it."""
    swing = Swing(centre)
    potential = quadratic(model)
    sigma1, sigma2 = potential.sigma1, potential.sigma2
    for _ in range(TIMES):
        law = NozzleLaw(NozzleGenerator(model, SMALL, swing))
        along, across = law.mean()
        swing = Swing(
            swing.centre + sigma1 * float(along[0].real),
            swing.along + 2 * sigma1 * complex(along[1]),
            swing.across + 2 * sigma2 * complex(across[1]),
        )
    return swing
