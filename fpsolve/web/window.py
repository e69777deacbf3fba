"""The part of the belt that is looked at, and its pixels."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_positive

__all__ = ["Window"]

# How far a side may be from a multiple of the pixel, relative to it: rounding of what
# was typed.
_TYPED = 1e-9


@dataclass(frozen=True)
class Window:
    """A rectangle of square pixels on the belt, in units of the throwing range.

    Attributes
    ----------
    width, length : float
        Across the belt and along it.
    pixel : float
    """

    width: float
    length: float
    pixel: float

    @classmethod
    def of(cls, width: Any, length: Any, pixel: Any) -> Window:
        """The window; ValueError unless its sides are multiples of the pixel."""
        sides = {
            "width": check_positive("width", width),
            "length": check_positive("length", length),
        }
        pixel = check_positive("pixel", pixel)
        for name, side in sides.items():
            if not pixel <= side * (1 + _TYPED):
                raise ValueError(
                    f"`pixel` must not be larger than the window, got {pixel:g} for "
                    f"`{name}` = {side:g}; a web of one pixel has pixel = {side:g}."
                )
        for name, side in sides.items():
            number = max(round(side / pixel), 1)
            if not abs(number * pixel - side) <= _TYPED * side:
                raise ValueError(
                    f"`{name}` must be a multiple of `pixel` = {pixel:g}, got {side:g};"
                    f" use {name} = {number * pixel:.12g}, or pixel = "
                    f"{side / number:.12g}."
                )
        return cls(sides["width"], sides["length"], pixel)

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of pixels across the belt and along it."""
        return round(self.width / self.pixel), round(self.length / self.pixel)

    @property
    def centres(self) -> tuple[Array, Array]:
        """Centres of the pixels across the belt and along it, from one corner."""
        across, along = (np.arange(number) + 0.5 for number in self.shape)
        return np.asarray(across * self.pixel), np.asarray(along * self.pixel)
