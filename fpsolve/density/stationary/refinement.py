"""The same density on coarser grids first: a start for the finest, and its error.

Not extrapolated: at which order the grids converge is not known, a factor covers it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.density.schemes.drift_kick import DriftKick
from fpsolve.density.stationary.coarser import carried, coarser_grid
from fpsolve.density.stationary.iteration import Stationary
from fpsolve.density.stationary.start import start_on
from fpsolve.errors import SteadyStateError

__all__ = ["SHARES", "Refined", "covering", "refined"]

# Computes the density of a scheme from a start and a step.
Solver = Callable[[DriftKick, Array, float], Stationary]

# Shares of the cells on the coarser grids.
SHARES = (1 / 2, 3 / 4)
# With an error ∝ n^{−q} the two differences from the finest grid are 2^q − 1 and
# (4/3)^q − 1 times its error: 3.9 apart for q = 2, where the second is 0.78 of it, and
# 3 apart for q = 1, where it is a third. A factor makes up for that.
LEAST_RATIO, LOW_ORDER, FACTOR = 5.0, 3.2, 1.3


@dataclass(frozen=True)
class Refined:
    """A stationary density and its differences from those on coarser grids.

    Attributes
    ----------
    finest : Stationary
    grid_error : ndarray, shape (n1, n2, n_alpha)
        Difference from the next coarser grid, scaled to cover the error.
    order : float
        At which the differences fall.
    n_applications : int
        On all grids.
    """

    finest: Stationary
    grid_error: Array
    order: float
    n_applications: int


def refined(scheme: DriftKick, ds: float, solver: Solver) -> Refined:
    """Solve on 1/2 and 3/4 of the cells and on all, each begun from the last.

    Raises
    ------
    SteadyStateError
        If `solver` does.
    """
    grid = scheme.grid
    grids = [*(coarser_grid(grid, share) for share in SHARES), grid]
    results: list[Stationary] = []
    for one in grids:
        here = type(scheme)(scheme.model, one, **scheme.options)
        try:
            found = solver(here, start_for(here, results), ds)
        except SteadyStateError:
            # The coarsest grid may be too coarse for anything.
            if one is not grids[0]:
                raise
            continue
        results.append(found)
        ds = found.ds
    *coarser, finest = results
    differences = [carried(p.density, grid.shape) - finest.density for p in coarser]
    factor, order = covering(differences)
    n_applications = sum(one.n_applications for one in results)
    return Refined(finest, factor * differences[-1], order, n_applications)


def start_for(scheme: DriftKick, coarser: Sequence[Stationary]) -> Array:
    """The density of the next coarser grid, or a guess on the first."""
    if not coarser:
        return start_on(scheme.grid, scheme.model)
    return carried(coarser[-1].evolved, scheme.grid.shape)


def covering(differences: Sequence[Array]) -> tuple[float, float]:
    """What the last difference from a coarser grid is multiplied by, and the order."""
    ratio = _ratio(differences[0], differences[-1])
    factor = FACTOR if ratio > LEAST_RATIO else LOW_ORDER
    return factor, math.log(ratio) / math.log(SHARES[1] / SHARES[0])


def _ratio(first: Array, second: Array) -> float:
    """How much larger the first difference is; at least one."""
    size = float(np.abs(second).sum())
    return max(1.0, float(np.abs(first).sum()) / size) if size > 0 else math.inf
