"""The same periodic density on coarser grids: a start for the finest, and its error."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.density.periodic.phases import Phases
from fpsolve.density.stationary.coarser import carried, coarser_grid
from fpsolve.density.stationary.iteration import Stationary
from fpsolve.density.stationary.refinement import SHARES, covering
from fpsolve.errors import SteadyStateError

__all__ = ["Refined", "refined"]

# The density at the first phase of a scheme, from a start and a step; and its phases.
Solver = Callable[[Any, Array | None, float], Stationary]
Reader = Callable[[Any, Stationary], Phases]


@dataclass(frozen=True)
class Refined:
    """A periodic density and its differences from those on coarser grids.

    Attributes
    ----------
    first : Stationary
        At s = 0 on the finest grid.
    phases : Phases
    grid_error : ndarray, shape (n, n1, n2, n_alpha)
        At every phase the difference from the next coarser grid, scaled to cover.
    order : float
        At which the differences fall.
    n_applications : int
        Strides on all grids.
    """

    first: Stationary
    phases: Phases
    grid_error: Array
    order: float
    n_applications: int


def refined(scheme: Any, ds: float, solver: Solver, reader: Reader) -> Refined:
    """Solve on 1/2 and 3/4 of the cells and on all, each begun from the last.

    The factor that covers is that of `fpsolve.density.stationary.refinement`.

    Raises
    ------
    SteadyStateError
        If `solver` does.
    """
    shape = scheme.grid.shape
    schemes = [
        type(scheme)(scheme.model, coarser_grid(scheme.grid, share), **scheme.options)
        for share in SHARES
    ]
    coarser: list[Array] = []
    start, n_applications = None, 0
    for here in schemes:
        try:
            found = solver(here, start, ds)
        except SteadyStateError:
            # The coarsest grid may be too coarse for anything.
            if here is not schemes[0]:
                raise
            continue
        ds, n_applications = found.ds, n_applications + found.n_applications
        coarser.append(_on_grid(reader(here, found).densities, shape))
        start = coarser[-1][0]
    first = solver(scheme, start, ds)
    phases = reader(scheme, first)
    differences = [one - phases.densities for one in coarser]
    factor, order = covering(differences)
    applied = n_applications + first.n_applications
    return Refined(first, phases, factor * differences[-1], order, applied)


def _on_grid(densities: Array, shape: tuple[int, ...]) -> Array:
    return np.stack([carried(p, shape) for p in densities])
