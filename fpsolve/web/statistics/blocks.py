"""Rectangles of a web that are nearly independent of each other."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_positive
from fpsolve.web.statistics.correlation import memories

__all__ = ["FEWEST_BLOCKS", "Blocks", "choose_blocks", "cut"]

# Of fewer, no standard error is worth its name: Student's t(2) already covers 95 % at
# 4.3 standard errors only.
FEWEST_BLOCKS = 4
# Aimed at where the web allows them: the error is then known to 18 %, for which the
# quantiles of Student's law make up, and longer blocks are more independent.
_BLOCKS = 16
# Relative; what rounding makes of the number of blocks.
_ROUNDING = 1e-9
# Sides of a block in correlation lengths, where neighbours share an eighth of what is
# in a block. What they share is made up for.
_CORRELATION_LENGTHS = 2.0


@dataclass(frozen=True)
class Blocks:
    """n = n₂ n₁ rectangles of nearly equal size that hold every cell exactly once.

    Parameters
    ----------
    cells : tuple of int
        Cells in cross and machine direction.
    counts : tuple of int
        Blocks in cross and machine direction.
    side : float
        Side that was aimed at.
    inflation : float
        By which the variance of a mean over the web exceeds that of independent
        blocks: those of side D along one axis give 1 - (ℓ - x)/(2 D) of it.
    """

    cells: tuple[int, int]
    counts: tuple[int, int]
    side: float
    inflation: float = 1.0

    @property
    def n_blocks(self) -> int:
        """Number of blocks."""
        return self.counts[0] * self.counts[1]

    def sums(self, field: Array) -> Array:
        """Σ over the cells of every block; axes behind the first two are kept."""
        for axis in (0, 1):
            n, count = self.cells[axis], self.counts[axis]
            field = np.add.reduceat(field, np.arange(count) * n // count, axis=axis)
        return field.reshape(self.n_blocks, *field.shape[2:])

    @property
    def labels(self) -> NDArray[np.int64]:
        """Number of the block of every cell, cross × machine direction."""
        bands = [
            np.searchsorted(np.arange(1, count) * n // count, np.arange(n), "right")
            for n, count in zip(self.cells, self.counts, strict=True)
        ]
        return bands[0][:, None] * self.counts[1] + bands[1]

    @property
    def sizes(self) -> Array:
        """Number of cells of every block."""
        return self.sums(np.ones(self.cells))

    @property
    def reason(self) -> str:
        """Why they allow no standard error; empty if they do."""
        if self.n_blocks >= FEWEST_BLOCKS:
            return ""
        return (
            f"the web holds {self.n_blocks} independent blocks of side "
            f"{self.side:.3g}, {FEWEST_BLOCKS} are needed; lay a larger web"
        )


def choose_blocks(
    field: Array, cell: float, block: float | None, shortest: float = 0.0
) -> Blocks:
    """Return blocks of two correlation lengths of a field, longer where 16 fit.

    Parameters
    ----------
    field : array
        What is averaged, cross × machine direction.
    cell : float
        Side x of a cell.
    block : float, optional
        Side of a block instead, of which all are taken for independent.
    shortest : float
        What a block must hold, such as the longest wave that is measured.
    """
    cells = field.shape
    if block is not None:
        side = max(check_positive("block", block), cell)
        return cut(cells, cell, (side, side))
    balanced = cell * math.sqrt(field.size / _BLOCKS)
    longest = max(balanced, shortest, cell)
    # Cells that are independent of each other are blocks themselves: what exceeds
    # a cell counts, or one of the bins in which correlations are looked for.
    memory = memories(field, cell)
    sides = [max(longest, cell + _CORRELATION_LENGTHS * one) for one in memory]
    blocks = cut(cells, cell, (sides[0], sides[1]))
    kept = [1.0 - one / (2.0 * side) for one, side in zip(memory, sides, strict=True)]
    return replace(blocks, inflation=1.0 / (kept[0] * kept[1]))


def cut(cells: Any, cell: float, sides: tuple[float, float]) -> Blocks:
    """Return as many blocks of at least these sides as fit, one at the least."""
    # Seven blocks of a tenth fit into 0.7, although 0.7/0.1 is a little less.
    fitting = [
        int(n * cell / side * (1.0 + _ROUNDING))
        for n, side in zip(cells, sides, strict=True)
    ]
    counts = [max(1, min(n, count)) for n, count in zip(cells, fitting, strict=True)]
    return Blocks((cells[0], cells[1]), (counts[0], counts[1]), max(sides))
