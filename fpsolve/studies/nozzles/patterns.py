"""The variation of mean patterns over a space of frequencies and radii, each once."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.errors import ToleranceError
from fpsolve.model.laydown import LayDownModel
from fpsolve.web.pattern import mean_pattern

__all__ = ["Asked", "At", "Patterns"]


class At(NamedTuple):
    """The pattern at one point.

    Attributes
    ----------
    cv, errors : ndarray
        By zone; NaN where no truncation is fine enough.
    """

    cv: Array
    errors: Array

    @property
    def square(self) -> float:
        """The mean of CV² over the zones; infinite where it is not known."""
        found = float(np.mean(self.cv**2))
        return found if np.isfinite(found) else np.inf

    @property
    def square_error(self) -> float:
        """Of `square`, (CV + e)² − CV²."""
        return float(np.mean(2 * self.cv * self.errors + self.errors**2))


@dataclass(frozen=True, eq=False)
class Asked:
    """What is designed.

    Attributes
    ----------
    model : LayDownModel
        Its nozzle has what is not free.
    names : tuple of str
        Fields of the nozzle that are free.
    zones : ndarray
    spacing : float
    phases : str or array
    tolerance : float
    """

    model: LayDownModel
    names: tuple[str, ...]
    zones: Array
    spacing: float
    phases: Any
    tolerance: float

    def at(self, values: Array) -> LayDownModel:
        """The model with other numbers; the nozzle keeps its direction."""
        curve: Any = self.model.curve
        given = dict(zip(self.names, map(float, values), strict=True))
        if "angular_speed" in given and curve.angular_speed < 0:
            given["angular_speed"] *= -1.0
        return replace(self.model, curve=replace(curve, **given))


@dataclass(eq=False)
class Patterns:
    """Patterns at the points that were asked for, in their order.

    Attributes
    ----------
    asked : Asked
    known : dict
        By the logarithms of the free numbers.
    """

    asked: Asked
    known: dict[tuple[float, ...], At] = field(default_factory=dict)

    def __call__(self, y: Array) -> At:
        """At logarithms of the free numbers."""
        key = tuple(map(float, y))
        if key not in self.known:
            self.known[key] = self._found(np.exp(y))
        return self.known[key]

    @property
    def points(self) -> Array:
        """Logarithms, (point, parameter)."""
        return np.array(list(self.known)).reshape(-1, len(self.asked.names))

    def _found(self, values: Array) -> At:
        asked = self.asked
        try:
            pattern = mean_pattern(
                asked.at(values), spacing=asked.spacing, phases=asked.phases,
                tolerance=asked.tolerance,
            )  # fmt: skip
        except ToleranceError:
            return At(*np.full((2, asked.zones.size), np.nan))
        pairs = [pattern.coefficient_of_variation(float(x)) for x in asked.zones]
        cv, errors = np.array(pairs).T
        return At(cv, errors)
