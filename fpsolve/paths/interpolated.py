"""Points with a density that is known at the cells of a grid."""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from fpsolve._support.arrays import Array
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.paths.rejection import CellRejection
from fpsolve.paths.spline_bounds import (
    SPLINE_ORDER,
    bounded_by,
    cell_averages,
    negative_share,
)

__all__ = ["InterpolatedDensity"]


# Largest share of negative mass in what is called a density.
MOST_NEGATIVE = 1e-2
# How far a spline rises above the values around a cell that resolve it: a Gaussian of
# the width of one cell gains 1.13 along each axis. Cells of almost no density are
# bounded relative to the largest value, since there the spline rings a little. Where it
# rises further, as beside a jump, `bounded_by` finds it.
MARGIN = 1.5
LEAST = 1e-5


class InterpolatedDensity:
    """Draws (ξ, α) from the quintic spline through a density on a grid."""

    def __init__(self, grid: PhaseSpaceGrid, p: Array) -> None:
        check_density(p)
        self.coefficients = ndimage.spline_filter(
            p / p.max(), order=SPLINE_ORDER, mode="grid-wrap"
        )
        check_interpolant(self.coefficients)
        # In units of cells; centres are whole numbers.
        around = ndimage.maximum_filter(p / p.max(), size=3, mode="wrap")
        self.grid = grid
        self.rejection = CellRejection(
            self._interpolant,
            low=(-0.5, -0.5, -0.5),
            high=tuple(n - 0.5 for n in grid.shape),
            shape=grid.shape,
            bounds=bounded_by(self.coefficients, np.maximum(MARGIN * around, LEAST)),
        )

    def __call__(self, rng: np.random.Generator, n: int) -> tuple[Array, Array]:
        """Draw n points: ξ of shape (n, 2) and α of shape (n,)."""
        places = self.rejection(rng, n) * self.grid.spacing
        points = self._first + places
        return points[:, :2], points[:, 2]

    def at_centres(self, grid: PhaseSpaceGrid) -> Array:
        """The density, not normalised, at the cell centres of another grid."""
        axes = (grid.xi1, grid.xi2, grid.alpha)
        own = zip(axes, self._first, self.grid.spacing, strict=True)
        places = np.meshgrid(*[(x - x0) / d for x, x0, d in own], indexing="ij")
        values = self._interpolant(np.reshape(places, (3, -1)))
        return np.maximum(values, 0.0).reshape(grid.shape)

    def cell_shares(self) -> Array:
        """Probabilities of the cells of the own grid."""
        averages = cell_averages(self.coefficients)
        return np.asarray(averages / averages.sum())

    @property
    def _first(self) -> Array:
        """Centre of the first cell."""
        return np.array([self.grid.xi1[0], self.grid.xi2[0], self.grid.alpha[0]])

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


def check_interpolant(coefficients: Array) -> None:
    """Raise ValueError if the spline through a density is negative by too much."""
    share = negative_share(coefficients)
    if not share <= MOST_NEGATIVE:
        raise ValueError(
            "`p` must be resolved by its grid to be sampled, got a share of "
            f"{share:.2g} of negative mass in the spline through its values (at most "
            f"{MOST_NEGATIVE:g}), as beside a jump; refine the grid, or smooth the "
            "density over two cells."
        )
