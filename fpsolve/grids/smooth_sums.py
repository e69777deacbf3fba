"""Mass and moments of a density with a curvature, from one pass over it."""

from __future__ import annotations

import numpy as np

from fpsolve._kernels.smooth import curvature_sums
from fpsolve._support.arrays import Array
from fpsolve.grids.row_sums import MOMENTS, RowFunctionals
from fpsolve.grids.smooth import SmoothPhaseSpaceGrid

__all__ = ["SMOOTH_MOMENTS", "SmoothFunctionals"]


SMOOTH_MOMENTS = (*MOMENTS, "mean_kappa", "mean_kappa2")


class SmoothFunctionals:
    """What is read off p(ξ, α, κ): the marginal of (ξ, α), and sums with κ.

    Parameters
    ----------
    p : ndarray, shape (n1, n2, n_alpha, n_kappa)
    grid : SmoothPhaseSpaceGrid

    Attributes
    ----------
    marginal : ndarray, shape (n1, n2, n_alpha)
        ∫ p dκ, a density on ``grid.phase_space``.
    rows : ndarray, shape (6, n1, n2)
        Σ over α and κ of κ p, κ² p, |p|, |p| at the ends of κ, max(-p, 0); min p.
    """

    def __init__(self, p: Array, grid: SmoothPhaseSpaceGrid) -> None:
        self.grid = grid
        n_xi1, n_xi2, n_alpha, n_kappa = grid.shape
        marginal = np.empty((n_xi1 * n_xi2, n_alpha))
        rows = np.empty((6, n_xi1 * n_xi2))
        curvature_sums(p.reshape(-1, n_alpha, n_kappa), grid.kappa, marginal, rows)
        marginal *= grid.spacing[3]
        self.marginal = marginal.reshape(grid.shape[:3])
        self.rows = rows.reshape(6, n_xi1, n_xi2)
        self.sums = RowFunctionals(self.marginal, grid.phase_space)

    def mass(self) -> float:
        """∫ p dξ dα dκ."""
        return self.sums.mass()

    def minimum(self) -> float:
        """The smallest value of p."""
        return float(self.rows[5].min())

    def negative_mass(self) -> float:
        """∫ max(-p, 0) dξ dα dκ."""
        return float(self.rows[4].sum()) * self.grid.cell_volume

    def kappa_boundary_mass(self) -> float:
        """Share of ∫ |p| in the first and the last cells of κ."""
        return float(self.rows[3].sum() / self.rows[2].sum())

    def moments(self) -> dict[str, float]:
        """SMOOTH_MOMENTS of the normalised density."""
        total = np.float64(self.sums.totals[0]) / self.grid.spacing[3]
        first, second = self.rows[0].sum() / total, self.rows[1].sum() / total
        curved = {"mean_kappa": float(first), "mean_kappa2": float(second)}
        return {**self.sums.moments(), **curved}
