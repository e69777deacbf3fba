"""Points with a density that is known at the cells of a grid."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from fpsolve.grids import PhaseSpaceGrid
from fpsolve.paths.rejection import CellRejection

__all__ = ["InterpolatedDensity"]

Array = NDArray[np.float64]

SPLINE_ORDER = 5
# Largest share of negative mass in what is called a density.
MOST_NEGATIVE = 1e-2
# How far a spline rises above the values around a cell, at most: a Gaussian of the
# width of one cell gains 1.13 along each axis. Cells of almost no density are bounded
# relative to the largest value, since there the spline rings a little.
MARGIN = 1.5
LEAST = 1e-5


class InterpolatedDensity:
    """Draws (ξ, α) from the quintic spline through a density on a grid."""

    def __init__(self, grid: PhaseSpaceGrid, p: Array) -> None:
        check_density(p)
        self.coefficients = ndimage.spline_filter(
            p / p.max(), order=SPLINE_ORDER, mode="grid-wrap"
        )
        # In units of cells; centres are whole numbers.
        around = ndimage.maximum_filter(p / p.max(), size=3, mode="wrap")
        self.grid = grid
        self.rejection = CellRejection(
            self._interpolant,
            low=(-0.5, -0.5, -0.5),
            high=tuple(n - 0.5 for n in grid.shape),
            shape=grid.shape,
            bounds=np.maximum(MARGIN * around, LEAST),
        )

    def __call__(self, rng: np.random.Generator, n: int) -> tuple[Array, Array]:
        """Draw n points: ξ of shape (n, 2) and α of shape (n,)."""
        places = self.rejection(rng, n) * self.grid.spacing
        first = np.array([self.grid.xi1[0], self.grid.xi2[0], self.grid.alpha[0]])
        points = first + places
        return points[:, :2], points[:, 2]

    def _interpolant(self, places: Array) -> Array:
        values: Array = ndimage.map_coordinates(
            self.coefficients,
            places,
            order=SPLINE_ORDER,
            mode="grid-wrap",
            prefilter=False,
        )
        return values


def check_density(p: Array) -> None:
    """Raise ValueError unless p is finite, with mass, and hardly negative."""
    if not np.isfinite(p).all():
        raise ValueError("`p` must be finite to be sampled, got NaN or infinity in it.")
    positive, negative = float(p[p > 0].sum()), float(-p[p < 0].sum())
    if not positive > 0:
        raise ValueError(f"`p` must have positive mass, got {p.sum():g}.")
    if not negative <= MOST_NEGATIVE * positive:
        raise ValueError(
            f"`p` must not be negative, got a share of {negative / positive:.2g} of "
            "negative mass; refine the grid or use `positive=True`."
        )
