"""Cell masses of a start: a density, one energy, or masses as they are."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array, check_numbers
from fpsolve.reduced.energy.checks import check_energies
from fpsolve.reduced.energy.grid import EnergyGrid

__all__ = ["masses_of", "starting_masses"]


_NODES, _WEIGHTS = leggauss(8)


def starting_masses(
    start: Callable[[Array], ArrayLike] | ArrayLike, grid: EnergyGrid
) -> Array:
    """Masses of the cells, of sum one.

    A density is integrated by eight Gauss points a cell. All mass at one energy is
    shared between the two cells whose centres enclose it, so that E G is exact; in
    front of the first centre, or behind the last one, it stays in that cell.

    Raises
    ------
    ValueError
        If values are negative or not finite, have no mass, or do not fit the grid.
    """
    masses = masses_of(start, grid)
    total = float(masses.sum())
    if not (masses.min() >= 0 and 0 < total < math.inf):
        raise ValueError(
            "`start` must be non-negative and finite with positive mass, got a minimum "
            f"of {masses.min():g} and a mass of {total:g}."
        )
    return masses / total


def masses_of(
    start: Callable[[Array], ArrayLike] | ArrayLike, grid: EnergyGrid
) -> Array:
    """Masses of the cells as they come, of any sum."""
    if callable(start):
        return _of_density(start, grid)
    if np.ndim(start) == 0:
        return _of_energy(start, grid)
    masses = check_numbers("start", start)
    if masses.shape != (grid.n_cells,):
        raise ValueError(
            f"`start` must have one mass for each of {grid.n_cells} cells, got shape "
            f"{masses.shape}; use `grid.histogram` for sampled energies."
        )
    return masses


def _of_density(density: Callable[[Array], ArrayLike], grid: EnergyGrid) -> Array:
    half = grid.widths[:, None] / 2
    points = grid.faces[:-1, None] + half * (_NODES + 1.0)
    values = check_numbers("start", density(points))
    if values.shape not in ((), points.shape):
        raise ValueError(
            f"`start` must work elementwise, got shape {values.shape} for energies of "
            f"shape {points.shape}."
        )
    return np.asarray((values * half) @ _WEIGHTS)


def _of_energy(start: ArrayLike, grid: EnergyGrid) -> Array:
    energy = float(check_energies("start", start, grid.g_max, signed=grid.signed))
    cells = np.arange(grid.n_cells)
    place = np.interp(energy, grid.centres, cells)
    left = min(int(place), grid.n_cells - 2)
    masses = np.zeros(grid.n_cells)
    masses[left], masses[left + 1] = 1.0 - (place - left), place - left
    return masses
