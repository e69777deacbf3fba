"""Sampling a density on a box by rejection, cell by cell."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from fpsolve._support.arrays import Array

__all__ = ["CellRejection", "drawn"]


# Points along each side of a cell at which the density is bounded, and what is added
# to the largest of them: between neighbours a resolved density rises by far less.
N_PROBES = 3
MARGIN = 1.1
FEWEST = 1024


def drawn(
    propose: Callable[[np.random.Generator, int], Array],
    rng: np.random.Generator,
    n: int,
    dimension: int,
) -> Array:
    """The first n points that are accepted of proposals, shape (n, dimension)."""
    found, missing = [np.empty((0, dimension))], n
    while missing > 0:
        accepted = propose(rng, max(2 * missing, FEWEST))
        found.append(accepted[:missing])
        missing -= len(found[-1])
    return np.concatenate(found)


class CellRejection:
    """Draws points with a density proportional to a function on a box.

    A cell is chosen by a bound of the function on it, a point uniformly in the cell,
    and kept with the ratio of the function to the bound. The result is exact as long
    as the bounds hold, which every accepted point checks.

    Parameters
    ----------
    density : callable
        Takes points of shape (d, n), gives n values; what is negative counts as zero.
    low, high : sequence of float
        Corners of the box, d numbers each.
    shape : sequence of int
        Numbers of cells.
    bounds : ndarray, optional
        Upper bounds on the cells; by default from probing the density.
    """

    def __init__(
        self,
        density: Callable[[Array], Array],
        low: Sequence[float],
        high: Sequence[float],
        shape: Sequence[int],
        bounds: Array | None = None,
    ) -> None:
        self.density, self.shape = density, tuple(shape)
        self.low = np.array(low, dtype=np.float64)
        self.width = (np.array(high, dtype=np.float64) - self.low) / self.shape
        self.bounds = (self._probed() if bounds is None else bounds).ravel()
        self.cumulated = np.cumsum(self.bounds)

    def __call__(self, rng: np.random.Generator, n: int) -> Array:
        """Draw n points, shape (n, d)."""
        return drawn(self._proposed, rng, n, len(self.shape))

    def _proposed(self, rng: np.random.Generator, n: int) -> Array:
        chosen = rng.uniform(0.0, self.cumulated[-1], n)
        cell = np.searchsorted(self.cumulated, chosen, side="right")
        cell = np.minimum(cell, self.bounds.size - 1)
        corner = np.stack(np.unravel_index(cell, self.shape), axis=1)
        points = self.low + (corner + rng.uniform(size=corner.shape)) * self.width
        values = self.density(points.T)
        bounds = self.bounds[cell]
        if not np.all(values <= bounds):
            worst = float(np.max(values / bounds))
            raise ValueError(
                "the density must be resolved by its cells to be sampled, got a value "
                f"of {worst:.3g} times the bound of its cell; refine the grid."
            )
        return np.asarray(points[rng.uniform(size=n) * bounds < values])

    def _probed(self) -> Array:
        """Largest value on a grid of probes in every cell, with a margin."""
        dimension = len(self.shape)
        corners = np.indices(self.shape).reshape(dimension, -1)
        probes = np.meshgrid(*[np.linspace(0.0, 1.0, N_PROBES)] * dimension)
        largest = np.zeros(corners.shape[1])
        for offset in np.reshape(probes, (dimension, -1)).T:
            places = (corners + offset[:, None]) * self.width[:, None]
            values = self.density(self.low[:, None] + places)
            largest = np.maximum(largest, values)
        return MARGIN * largest.reshape(self.shape)
