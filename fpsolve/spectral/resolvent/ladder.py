"""Truncations of growing size, until two in a row agree."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.errors import ToleranceError
from fpsolve.model.laydown import LayDownModel
from fpsolve.spectral.evolution.quadratic import quadratic
from fpsolve.spectral.resolvent.basis import Basis
from fpsolve.spectral.resolvent.centre import centre_of
from fpsolve.spectral.resolvent.generator import Generator

__all__ = ["Ladder"]

# A √σ below which a fibre goes round several times before it forgets.
LOW_NOISE = 1.0
Allowed = Callable[[Array], Array]
# The factors of more states take gigabytes and minutes.
MOST_STATES = 24_000
# What rounding leaves of the numbers, relative to the largest.
ROUNDING = 1e-11
# Of a change, and of the change before: at low noise the numbers do not converge
# monotonically. Measured by validation/web_prediction.py.
SAFETY, MEMORY = 2.0, 0.5


@dataclass(eq=False)
class Ladder:
    """Generators of a model in bases of growing size, kept for the next wave vector.

    Attributes
    ----------
    model : LayDownModel
    centre : float
        Of all bases.
    """

    # The change before the first one, in units of what is allowed.
    unseen: ClassVar[float] = 0.0

    model: LayDownModel
    centre: float = field(init=False)
    _kept: dict[Basis, Generator] = field(default_factory=dict, init=False)

    def __post_init__(self) -> None:
        self.centre = centre_of(self.model)

    @property
    def scales(self) -> tuple[float, float]:
        """The throwing ranges."""
        potential = quadratic(self.model)
        return potential.sigma1, potential.sigma2

    def generator(self, basis: Basis) -> Generator:
        """The generator in a basis."""
        if basis not in self._kept:
            self._kept[basis] = Generator(self.model, basis, self.centre)
        return self._kept[basis]

    def climb(
        self,
        first: Any,
        compute: Callable[[Any], Array],
        allowed: Allowed,
        level: int = 0,
        most: int = MOST_STATES,
        unseen: float | None = None,
    ) -> tuple[Array, Array, int]:
        """What `compute` returns, bounds of its errors, and the level.

        The change from the truncation before shrinks at least geometrically with the
        size, so that it bounds the error of the larger truncation. At low noise one
        number may agree by chance: in units of what is allowed, the error of each is
        twice the largest of all changes, and at least half of that of the step before.

        The first column decides. Others, derivatives, have errors by the same rule in
        units of their own, and none changes less than the first.

        Parameters
        ----------
        first : Basis
            Of level 0; whatever has a `size` and `grown(level)`.
        compute : callable
            Of a generator an array (number, column), or (number,).
        allowed : callable
            Of what was computed, the largest errors, and the units of other columns.
        level : int
            To begin at.
        most : int
            States of the largest truncation.
        unseen : float, optional
            In place of that of the class: infinite, three truncations must agree.

        Raises
        ------
        ToleranceError
            If even the largest truncation is not fine enough. A larger noise is named
            only where it is a remedy.
        """
        coarse = columns(compute(self.generator(grown(first, level))))
        reached, tolerance = np.inf, np.nan
        before = np.full(coarse.shape[1], self.unseen if unseen is None else unseen)
        while grown(first, level + 1).size <= most:
            level += 1
            found = compute(self.generator(grown(first, level)))
            fine, limit = columns(found), columns(allowed(found))
            change = np.max(np.abs(fine - coarse) / limit, axis=0)
            change = np.maximum(change, change[0])
            error = limit * np.maximum(SAFETY * change, MEMORY * before)
            error = error + ROUNDING * np.abs(fine)
            if (error <= limit)[:, 0].all():
                return found, error.reshape(found.shape), level
            worst = error[:, 0].argmax()
            reached, tolerance = float(error[worst, 0]), float(limit[worst, 0])
            coarse, before = fine, change
        remedy = f"raise `tolerance`: no truncation of {most} states is fine enough"
        if self.model.noise * min(self.scales) ** 0.5 < LOW_NOISE:
            remedy += f"; or the noise, with {self.model.noise:g} orbits last for long"
        raise ToleranceError(reached, tolerance, remedy)


def columns(found: Array) -> Array:
    """Numbers as a column."""
    return found.reshape(len(found), -1)


def grown(first: Any, level: int) -> Any:
    """The basis that is `level` steps larger."""
    return first.grown(level)
