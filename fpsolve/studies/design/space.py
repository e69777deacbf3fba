"""The parameters that may change: their bounds, and the base weight they keep."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.optimize import brentq

from fpsolve._support.arrays import Array
from fpsolve._support.checks import shown
from fpsolve.studies.arguments import checked_pair, series_of
from fpsolve.studies.design.settings import (
    BASE_WEIGHT,
    OF_PROCESS,
    PARAMETERS,
    Settings,
)
from fpsolve.web.order import checked_titer

__all__ = ["Space", "space_of"]

# Of the logarithm of the base weight; what rounding makes of it.
_ROUNDING = 1e-12


@dataclass(frozen=True, eq=False)
class Space:
    """Logarithms y of the free parameters, low <= y <= high and row · y = constant.

    Attributes
    ----------
    start : Settings
        Whose base weight is kept, and whose other parameters.
    names : tuple of str
        Free parameters.
    low, high : ndarray
        Logarithms of the bounds.
    """

    start: Settings
    names: tuple[str, ...]
    low: Array
    high: Array

    @property
    def row(self) -> Array:
        """What keeps the base weight: row · y is constant; zeros where nothing can."""
        return np.array([BASE_WEIGHT.get(name, 0.0) for name in self.names])

    @property
    def places(self) -> list[int]:
        """Of the free parameters among all."""
        return [PARAMETERS.index(name) for name in self.names]

    @property
    def origin(self) -> Array:
        """Logarithms of the start, which may lie outside of the bounds."""
        return np.log(self.start.values[self.places])

    def settings(self, y: Array) -> Settings:
        """The process at a point."""
        return self.start.changed(self.names, np.exp(y))

    def nearest(self, y: Array) -> Array:
        """The point of the space that is nearest to another one.

        It is clip(y + μ row), with the μ that keeps the base weight.

        Raises
        ------
        ValueError
            If no point within the bounds keeps it.
        """
        row, kept = self.row, float(self.row @ self.origin)

        def away(mu: float) -> float:
            return float(row @ np.clip(y + mu * row, self.low, self.high)) - kept

        far = float(np.abs(y - self.origin).sum()) + self._widest
        if abs(away(0.0)) <= _ROUNDING or not row.any():
            return np.asarray(np.clip(y, self.low, self.high))
        if not away(-far) <= _ROUNDING or not away(far) >= -_ROUNDING:
            raise ValueError(
                "`bounds` must leave a process of the base weight "
                f"{self.start.base_weight:g} g/m² = titer/(speed_ratio spacing), got "
                f"none within {self._told()}; widen them."
            )
        mu = brentq(away, -far, far, xtol=1e-15, rtol=1e-15)
        return np.asarray(np.clip(y + mu * row, self.low, self.high))

    def pinned(self, name: str, y: float) -> Space:
        """With one parameter held at a logarithm."""
        held = np.array([one == name for one in self.names])
        return replace(
            self, low=np.where(held, y, self.low), high=np.where(held, y, self.high)
        )

    def reach(self, name: str) -> tuple[float, float]:
        """From where to where one parameter can go while the base weight is kept."""
        place, row = self.names.index(name), self.row
        low, high = float(self.low[place]), float(self.high[place])
        if row[place] == 0:
            return low, high
        others = [n for n in range(len(row)) if n != place and row[n] != 0]
        kept = float(row @ self.origin)
        ends = [
            (kept - sum(row[n] * one[n] for n in others)) / row[place]
            for one in (
                np.where(row > 0, self.low, self.high),
                np.where(row > 0, self.high, self.low),
            )
        ]
        return max(low, min(ends)), min(high, max(ends))

    @property
    def _widest(self) -> float:
        """A shift after which every finite bound counts."""
        ends = np.concatenate([self.low, self.high])
        finite = ends[np.isfinite(ends)]
        return float(np.abs(finite).sum() + np.abs(self.origin).sum()) + 1.0

    def _told(self) -> str:
        ends = zip(self.names, np.exp(self.low), np.exp(self.high), strict=True)
        return ", ".join(
            f"{name} {low:g} to {high:g}" for name, low, high in ends
            if name in BASE_WEIGHT
        )  # fmt: skip


def space_of(start: Settings, free: Any, bounds: Any) -> Space:
    """The space of the arguments of `design_web`, checked."""
    names = checked_names(free)
    if "relaxation_length" in names and start.process.relaxation_length is None:
        raise ValueError(
            "`process` must have a `relaxation_length` for it to be free, got none; "
            "where the search begins decides between the models."
        )
    ends = checked_bounds({} if bounds is None else bounds, names)
    for name, pair in ends.items():
        for end in pair:
            # They know what is possible, and warn of what is unusual.
            if name in OF_PROCESS:
                replace(start.process, **{name: end})
            elif name == "titer":
                checked_titer(end, start.process)
    with np.errstate(divide="ignore"):
        low, high = np.log(np.array([ends[name] for name in names])).T
    space = Space(start, names, low, high)
    space.nearest(space.origin)
    return space


def checked_names(free: Any) -> tuple[str, ...]:
    """The free parameters in the order of `PARAMETERS`."""
    named = series_of(free, "free", "names")
    unknown = [one for one in named if one not in PARAMETERS]
    if unknown or not named:
        raise ValueError(
            f"`free` must be among {', '.join(PARAMETERS)}, got "
            f"{', '.join(map(shown, unknown)) or 'none'}; the web depends on nothing "
            "else that `predict_web` knows, and moving nozzles it does not predict: "
            "`design_nozzles` has their frequency and radii, for the pattern they lay."
        )
    bound = [one for one in BASE_WEIGHT if one in named]
    if len(bound) == 1:
        raise ValueError(
            "`free` must name two of speed_ratio, spacing and titer or none, got "
            f"{bound[0]} alone, which the base weight titer/(speed_ratio spacing) "
            "holds; free another one with it."
        )
    return tuple(one for one in PARAMETERS if one in named)


def checked_bounds(
    bounds: Any, names: tuple[str, ...]
) -> dict[str, tuple[float, float]]:
    """Lowest and highest value of each free parameter."""
    if not isinstance(bounds, Mapping):
        raise TypeError(
            "`bounds` must be a mapping of names to (lowest, highest), got "
            f"{shown(bounds)}."
        )
    unknown = [shown(one) for one in bounds if one not in names]
    if unknown:
        raise ValueError(
            f"`bounds` must be of free parameters, {', '.join(names)}, got "
            f"{', '.join(unknown)}; name it in `free` too."
        )
    missing = [one for one in names if one not in bounds and one != "spacing"]
    if missing:
        raise ValueError(
            f"`bounds` must be given for {', '.join(missing)}, got none; only those of "
            "the spacing follow from others."
        )
    given = {name: checked_pair(name, pair) for name, pair in bounds.items()}
    return {name: given.get(name, (0.0, math.inf)) for name in names}
