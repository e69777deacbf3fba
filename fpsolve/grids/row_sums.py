"""Mass, entropy, dissipation and moments from one pass over a density."""

from __future__ import annotations

import math

import numpy as np

from fpsolve._kernels.functionals import N_FUNCTIONALS, row_functionals
from fpsolve._support.arrays import Array
from fpsolve.grids.phase_space import PhaseSpaceGrid

# Reference values below this carry no mass; they only have to be divisible.
SMALLEST = 1e-300
MOMENTS = (
    "mean_xi1",
    "mean_xi2",
    "variance_xi1",
    "variance_xi2",
    "covariance",
    "mean_cos_alpha",
    "mean_sin_alpha",
)


def inverse_of(reference: Array, ratio: float) -> Array:
    """1/(ratio r), what p is multiplied by under the logarithm."""
    inverse: Array = 1.0 / np.maximum(reference * ratio, SMALLEST)
    return inverse


class RowFunctionals:
    """Sums over α for every ξ, shape (7, n1, n2), and their totals.

    Parameters
    ----------
    p : ndarray, shape (n1, n2, n_alpha)
    grid : PhaseSpaceGrid
    inverse : ndarray, shape (n1, n2), optional
        `inverse_of(r, ratio)` for the entropy relative to r.

    Attributes
    ----------
    rows : ndarray, shape (7, n1, n2)
        Σ_k of p, p cos α, p sin α, (δ√p)²; min_k p; Σ_k of max(−p, 0), p ln(p inverse).
    totals : list of float
        Sums of `rows` over ξ; that of the minima means nothing.
    """

    def __init__(
        self, p: Array, grid: PhaseSpaceGrid, inverse: Array | None = None
    ) -> None:
        rows = np.empty((N_FUNCTIONALS, *grid.shape[:2]))
        inverse = np.ones((1, 1)) if inverse is None else inverse
        row_functionals(p, np.cos(grid.alpha), np.sin(grid.alpha), inverse, rows)
        self._take(rows, grid)

    @classmethod
    def of_rows(cls, rows: Array, grid: PhaseSpaceGrid) -> RowFunctionals:
        """Those whose `rows` were found elsewhere."""
        made = cls.__new__(cls)
        made._take(rows, grid)
        return made

    def _take(self, rows: Array, grid: PhaseSpaceGrid) -> None:
        self.grid, self.rows = grid, rows
        self.totals: list[float] = rows.sum(axis=(1, 2)).tolist()

    def mass(self) -> float:
        """∫ p dξ dα."""
        return self.totals[0] * self.grid.cell_volume

    def minimum(self) -> float:
        """The smallest value of p."""
        return float(self.rows[4].min())

    def negative_mass(self) -> float:
        """∫ max(−p, 0) dξ dα."""
        return self.totals[5] * self.grid.cell_volume

    def relative_entropy(self, ratio: float) -> float:
        """H(p|r), with `inverse_of(r, ratio)` under the logarithm; NaN without mass."""
        total = self.totals[0]
        if not (total > 0.0 and ratio > 0.0):
            return math.nan
        return (self.totals[6] + total * math.log(ratio)) * self.grid.cell_volume

    def entropy_dissipation(self, noise: float) -> float:
        """2A² ∫ (∂_α √p)² dξ dα, the dissipation for a reference free of α."""
        squares = self.totals[3] / self.grid.spacing[2] ** 2
        return 2.0 * noise**2 * squares * self.grid.cell_volume

    def moments(self) -> dict[str, float]:
        """MOMENTS of the normalised density."""
        plane, total = self.rows[0], np.float64(self.totals[0])
        share1, share2 = plane.sum(axis=1) / total, plane.sum(axis=0) / total
        mean1, mean2 = (share1 * self.grid.xi1).sum(), (share2 * self.grid.xi2).sum()
        away1, away2 = self.grid.xi1 - mean1, self.grid.xi2 - mean2
        values = (
            mean1,
            mean2,
            (share1 * away1**2).sum(),
            (share2 * away2**2).sum(),
            ((plane * away2).sum(axis=1) * away1).sum() / total,
            self.totals[1] / total,
            self.totals[2] / total,
        )
        return dict(zip(MOMENTS, map(float, values), strict=True))
