"""Paths counted in the cells of a grid."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array
from fpsolve.grids import diagnostics
from fpsolve.grids.phase_space import PhaseSpaceGrid

__all__ = ["Histogram", "count_paths", "wrapped"]

TURN = 2.0 * np.pi


def wrapped(alpha: Array) -> Array:
    """The angle in [0, 2π)."""
    inside: Array = np.mod(alpha, TURN)
    # A tiny negative angle rounds to 2π itself.
    return np.where(inside >= TURN, 0.0, inside)


def count_paths(
    grid: PhaseSpaceGrid, xi1: Array, xi2: Array, alpha: Array
) -> tuple[NDArray[np.int64], int]:
    """Numbers of paths in the cells, and of those outside of the ξ box."""
    (n1, n2, n_alpha), (d1, d2, d_alpha) = grid.shape, grid.spacing
    half1, half2 = grid.half_widths
    i = np.floor((xi1 + half1) / d1)
    j = np.floor((xi2 + half2) / d2)
    k = np.minimum(np.floor(wrapped(alpha) / d_alpha), n_alpha - 1)
    inside = (i >= 0) & (i < n1) & (j >= 0) & (j < n2)
    cells = ((i * n2 + j) * n_alpha + k)[inside].astype(np.int64)
    counts = np.bincount(cells, minlength=grid.n_cells).reshape(grid.shape)
    return counts, int(xi1.size - cells.size)


@dataclass(frozen=True, eq=False)
class Histogram:
    """Numbers of paths in the cells of a grid at one s.

    Attributes
    ----------
    grid : PhaseSpaceGrid
    s : float
    counts : ndarray of int64, shape ``grid.shape``
    outside : int
        Paths outside of the ξ box; counted, not dropped.
    n_paths : int
    """

    grid: PhaseSpaceGrid
    s: float
    counts: NDArray[np.int64] = field(repr=False)
    outside: int
    n_paths: int

    @property
    def density(self) -> Array:
        """Counts / (n_paths · cell volume): estimates of the averages of p."""
        estimate: Array = self.counts / (self.n_paths * self.grid.cell_volume)
        return estimate

    @property
    def standard_error(self) -> Array:
        """√(q (1 - q)/n)/cell volume, where q is the share of a cell."""
        share = self.counts / self.n_paths
        error = np.sqrt(share * (1.0 - share) / self.n_paths)
        return np.asarray(error / self.grid.cell_volume)

    def marginal(self, which: str) -> Array:
        """Density of "xi", "alpha", "xi1" or "xi2", averaged over cells."""
        return diagnostics.marginal(self.density, self.grid, which)
