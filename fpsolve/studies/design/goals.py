"""What is minimised over a space, and what has to hold, with derivatives.

Unknowns are x = (y, t): the logarithms of the free parameters, and a bound t of the
worst zone for the goal that has one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.studies.design.predictions import At
from fpsolve.studies.design.space import Space

__all__ = ["Cheapest", "Evenest", "Goal", "Worst"]

Value = tuple[float, Array]
Values = tuple[Array, Array]


class Goal(Protocol):
    """An objective, and numbers that must not be negative."""

    n_extra: int

    def objective(self, x: Array, at: At) -> Value:
        """What is minimised, and its gradient."""

    def margins(self, x: Array, at: At) -> Values:
        """What must not be negative, and its Jacobian."""

    def weights(self, targets: Array) -> Array:
        """Of log CV in the Lagrangian, by the multipliers of the margins."""


@dataclass(frozen=True, eq=False)
class Evenest:
    """The mean of log CV over the zones: the geometric mean of CV.

    Attributes
    ----------
    space : Space
    n_zones : int
    """

    space: Space
    n_zones: int
    n_extra = 0

    def objective(self, x: Array, at: At) -> Value:
        """The mean of log CV."""
        slopes = at.slopes[self.space.places]
        return float(np.log(at.cv).mean()), slopes.mean(axis=1)

    def margins(self, x: Array, at: At) -> Values:
        """None."""
        return np.zeros(0), np.zeros((0, x.size))

    def weights(self, targets: Array) -> Array:
        """The same for all zones."""
        return np.full(self.n_zones, 1.0 / self.n_zones)


@dataclass(frozen=True, eq=False)
class Cheapest:
    """−log of a parameter, where log CV is below its bounds.

    Attributes
    ----------
    space : Space
    largest : ndarray
        Of CV.
    name : str
        The parameter that is to be large.
    """

    space: Space
    largest: Array
    name: str
    n_extra = 0

    def objective(self, x: Array, at: At) -> Value:
        """Less where the parameter is large."""
        place = self.space.names.index(self.name)
        return float(-x[place]), -np.eye(x.size)[place]

    def margins(self, x: Array, at: At) -> Values:
        """Of every zone how far log CV is below its bound."""
        slopes = at.slopes[self.space.places]
        return np.log(self.largest / at.cv), -slopes.T

    def weights(self, targets: Array) -> Array:
        """The multipliers."""
        return targets


@dataclass(frozen=True, eq=False)
class Worst:
    """The largest of log (CV/bound) over the zones, t.

    Attributes
    ----------
    space : Space
    largest : ndarray
        Of CV.
    """

    space: Space
    largest: Array
    n_extra = 1

    def objective(self, x: Array, at: At) -> Value:
        """It is t."""
        return float(x[-1]), np.eye(x.size)[-1]

    def margins(self, x: Array, at: At) -> Values:
        """Of every zone how far log (CV/bound) is below t."""
        slopes = at.slopes[self.space.places]
        ones = np.ones((self.largest.size, 1))
        return x[-1] - np.log(at.cv / self.largest), np.hstack([-slopes.T, ones])

    def weights(self, targets: Array) -> Array:
        """The multipliers."""
        return targets
