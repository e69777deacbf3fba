"""Counts of a web on a disk, and what is made of them, piece by piece."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.web.laying import Counts, Laid, image_shape, total
from fpsolve.web.order import Order, pixels_of

__all__ = ["CountedFile", "PixelBlocks"]

# Pixels that are made of counts at once.
AT_ONCE = 2**18


class CountedFile:
    """The counts of all pixels in a file, of which a part at a time is in memory."""

    def __init__(self, path: Path, order: Order) -> None:
        self.path, self.order = path, order
        self.shape = image_shape(order.plan)
        with path.open("wb") as file:
            file.truncate(8 * int(np.prod(self.shape)))

    def mapped(self, mode: Any = "r") -> Counts:
        """The file as an array; its pages are in memory until nothing refers to it."""
        return np.memmap(self.path, np.int64, mode, shape=self.shape)

    def add(self, laid: Laid) -> None:
        """Count what was laid."""
        n_rows, n_columns = laid.counts.shape[:2]
        rows = slice(laid.row, laid.row + n_rows)
        columns = slice(laid.column, laid.column + n_columns)
        self.mapped("r+")[rows, columns] += laid.counts

    def row_blocks(self) -> Iterator[tuple[slice, Counts]]:
        """Some rows after the other."""
        step = max(AT_ONCE // self.shape[1], 1)
        for start in range(0, self.shape[0], step):
            rows = slice(start, start + step)
            yield rows, np.array(self.mapped()[rows])

    def tiles(self, n_columns: int) -> Iterator[tuple[slice, Counts]]:
        """So many columns after the other."""
        for start in range(0, self.shape[1], n_columns):
            columns = slice(start, min(start + n_columns, self.shape[1]))
            yield columns, np.array(self.mapped()[:, columns])

    @property
    def inside(self) -> int:
        """All counts of length."""
        return sum(total(counts) for _, counts in self.row_blocks())


@dataclass(frozen=True)
class PixelBlocks:
    """One of the numbers of every pixel, made of the counts whenever it is asked for.

    Attributes
    ----------
    counted : CountedFile
    name : str
        Of the variable.
    n_columns : int
        Of a tile.
    """

    counted: CountedFile
    name: str
    n_columns: int

    def __iter__(self) -> Iterator[Array]:
        """Rows by rows."""
        for _, counts in self.counted.row_blocks():
            yield self._of(counts)

    def tiles(self) -> Iterator[tuple[Any, Array]]:
        """Columns by columns, with their index."""
        for columns, counts in self.counted.tiles(self.n_columns):
            yield (slice(None), columns), self._of(counts)

    def _of(self, counts: Counts) -> Array:
        length, first, mixed = pixels_of(counts, self.counted.order)
        titer = self.counted.order.titer
        if self.name == "mass_density" and titer is not None:
            return titer * length
        named = {"length_density": length, "orientation_11": first,
                 "orientation_12": mixed}  # fmt: skip
        return named[self.name]
