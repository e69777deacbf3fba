"""Counts of a web on a disk, and what is made of them, piece by piece."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.web.laying import Counts, Laid, image_shape, total
from fpsolve.web.order import Order, pixels_of

__all__ = ["CountedFile", "PixelBlocks"]

# Pixels that are made of counts at once.
AT_ONCE = 2**18
# Of a count.
BYTES = 8


class CountedFile:
    """The counts of all pixels in a file, of which a part at a time is in memory.

    It is read and written, not mapped: of a file that is mapped the system counts what
    lies around a part as memory, too.
    """

    def __init__(self, path: Path, order: Order) -> None:
        self.path, self.order = path, order
        self.shape = image_shape(order.plan)
        with path.open("wb") as file:
            file.truncate(BYTES * int(np.prod(self.shape)))

    def add(self, laid: Laid) -> None:
        """Count what was laid."""
        with self.path.open("r+b") as file:
            for row, counts in enumerate(laid.counts, laid.row):
                known = self._read(file, row, laid.column, len(counts))
                self._seek(file, row, laid.column)
                file.write(np.ascontiguousarray(known + counts).data)

    def row_blocks(self) -> Iterator[Counts]:
        """Some rows after the other."""
        n_rows, n_columns, _ = self.shape
        step = max(AT_ONCE // n_columns, 1)
        for start in range(0, n_rows, step):
            yield self.part(range(start, min(start + step, n_rows)), 0, n_columns)

    def tiles(self, n_columns: int) -> Iterator[tuple[slice, Counts]]:
        """So many columns after the other."""
        rows = range(self.shape[0])
        for start in range(0, self.shape[1], n_columns):
            columns = slice(start, min(start + n_columns, self.shape[1]))
            yield columns, self.part(rows, start, columns.stop - start)

    def part(self, rows: range, column: int, n_columns: int) -> Counts:
        """The counts of some rows, from a column on."""
        with self.path.open("rb") as file:
            return np.stack([self._read(file, row, column, n_columns) for row in rows])

    def _read(self, file: IO[bytes], row: int, column: int, n_columns: int) -> Counts:
        n_counted = self.shape[2]
        self._seek(file, row, column)
        found = file.read(BYTES * n_columns * n_counted)
        return np.frombuffer(found, np.int64).reshape(n_columns, n_counted)

    def _seek(self, file: IO[bytes], row: int, column: int) -> None:
        _, n_columns, n_counted = self.shape
        file.seek(BYTES * n_counted * (row * n_columns + column))

    @property
    def inside(self) -> int:
        """All counts of length."""
        return sum(total(counts) for counts in self.row_blocks())


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
        for counts in self.counted.row_blocks():
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
