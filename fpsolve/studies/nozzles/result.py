"""Nozzles as they were designed."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.evolution.call import Call
from fpsolve.evolution.saved import Saved
from fpsolve.model.laydown import LayDownModel
from fpsolve.studies.nozzles.layout import NOZZLES

__all__ = ["NozzleDesign"]

# Of a logarithm at its bound.
AT_BOUND = 1e-6


@dataclass(frozen=True, eq=False)
class NozzleDesign(Saved):
    """Frequency and radii with which nozzles lay the most even pattern, and the scan.

    Attributes
    ----------
    model : LayDownModel or None
        The optimal one.
    names : tuple of str
        Free numbers of its nozzle; arrays over parameters have their order.
    spacing : float
        Distance of neighbouring nozzles.
    phases : str or tuple of float
    lower, upper : ndarray
        Bounds of the free numbers.
    ranges : ndarray, shape (2, parameter)
        From where to where the optimum may be: all points whose pattern the errors do
        not tell from the best one, to the next points that were computed.
    zones : ndarray
        Sides of square zones.
    pattern_cv, pattern_errors : ndarray
        CV of the mean pattern at the optimum, and its errors.
    points : ndarray, shape (point, parameter)
        Where patterns were computed: the scan, then the searches of its valleys.
    n_scanned : int
        Points of the scan.
    points_cv, points_errors : ndarray, shape (point, zone)
        CV of their patterns; NaN where no truncation is fine enough.
    laid_pattern, laid_pattern_errors : ndarray
        CV² that laid webs have in common, and its standard errors; NaN without webs. It
        has no bias, and may be negative by chance.
    laid, laid_errors : ndarray
        CV² of the webs themselves, their fibres included, and standard errors.
    n_webs : int
        Laid for every zone.
    call : Call or None
        How it was made.
    provenance : dict
        Versions, environment, date and times.
    """

    kind: ClassVar[str] = "nozzle-design"
    layout = NOZZLES

    model: LayDownModel | None
    names: tuple[str, ...]
    spacing: float
    phases: str | tuple[float, ...]
    lower: Array
    upper: Array
    ranges: Array
    zones: Array
    pattern_cv: Array
    pattern_errors: Array
    points: Array = field(repr=False)
    n_scanned: int
    points_cv: Array = field(repr=False)
    points_errors: Array = field(repr=False)
    laid_pattern: Array
    laid_pattern_errors: Array
    laid: Array
    laid_errors: Array
    n_webs: int
    call: Call | None = field(default=None, repr=False)
    provenance: dict[str, Any] = field(default_factory=dict, repr=False)

    @property
    def values(self) -> Array:
        """The free numbers at the optimum."""
        return np.asarray(self.points[int(np.nanargmin(self.squares))])

    @property
    def squares(self) -> Array:
        """What is minimised, the mean of CV² over the zones, at every point."""
        return np.asarray(np.mean(self.points_cv**2, axis=1))

    @property
    def n_unknown(self) -> int:
        """Points where no truncation was fine enough."""
        return int(np.isnan(self.squares).sum())

    @property
    def active(self) -> tuple[str, ...]:
        """Bounds at which the optimum is: "angular_speed at its upper bound"."""
        return tuple(
            f"{name} at its {side} bound"
            for name, value, *ends in zip(
                self.names, self.values, self.lower, self.upper, strict=True
            )
            for side, end in zip(("lower", "upper"), ends, strict=True)
            if abs(np.log(value / end)) <= AT_BOUND
        )

    @property
    def z(self) -> Array:
        """Difference of both CV² of the pattern over its error: laid less predicted."""
        error = 2 * self.pattern_cv * self.pattern_errors + self.pattern_errors**2
        both = np.hypot(self.laid_pattern_errors, error)
        return np.asarray((self.laid_pattern - self.pattern_cv**2) / both)

    def __repr__(self) -> str:
        free = ", ".join(
            f"{name} {value:.4g}"
            for name, value in zip(self.names, self.values, strict=True)
        )
        told = ", ".join(
            f"{cv:.4g} ± {error:.1g} at {zone:g}"
            for zone, cv, error in zip(
                self.zones, self.pattern_cv, self.pattern_errors, strict=True
            )
        )
        return f"NozzleDesign({free}: CV of the pattern {told})"
