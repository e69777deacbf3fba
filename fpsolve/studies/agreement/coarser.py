"""The same run on coarser grids: their differences estimate the error of the grid."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array
from fpsolve.density.schemes.dictionaries import describe_scheme, scheme_from_dict
from fpsolve.density.schemes.scheme import Scheme
from fpsolve.density.smooth.marginal import without_curvature
from fpsolve.density.solution import Solution
from fpsolve.density.solve import solve
from fpsolve.errors import FpsolveError
from fpsolve.grids import diagnostics
from fpsolve.grids.initial import with_curvature
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.smooth import SmoothPhaseSpaceGrid
from fpsolve.studies.agreement.cell_probabilities import cell_probabilities
from fpsolve.studies.agreement.partition import equal_probability_boxes
from fpsolve.studies.starts import density_and_law

if TYPE_CHECKING:
    from fpsolve.paths.laws import DensityLaw

__all__ = [
    "GridError",
    "coarsened",
    "coarser_runs",
    "on_grid",
    "start_noncentrality",
    "within_error",
]

# What a geometric series of differences is multiplied by, and the least share of one
# that is the error: orders above eight are not believed.
_CAUTION, _LEAST = 2.0, 0.2
# Boxes that are compared, at most, and the least probability of one.
_BOXES, _LEAST_SHARE = 512, 1e-4
_TINY = 1e-300
# A run that is expected to be poor is not stopped for it.
_LENIENT = {"mass_tolerance": 1.0, "boundary_tolerance": 1.0, "negative_tolerance": 1.0}


class GridError(NamedTuple):
    """How far the grid may take a density.

    Attributes
    ----------
    factor : float
        Of the difference from the first coarser run.
    cells : ndarray, shape grid.shape
        Change of the probabilities of cells.
    distance : float
        L1 error of the probabilities of boxes.
    """

    factor: float
    cells: Array
    distance: float


def coarsened(grid: Any) -> Any:
    """The same box with cells longer by about 4/3, in even numbers.

    Those of a curvature stay: they have to resolve it, and paths are not asked for it.
    """
    n1, n2, n_alpha = (2 * math.ceil(3 * n / 8) for n in grid.shape[:3])
    if isinstance(grid, SmoothPhaseSpaceGrid):
        return replace(grid, shape=(n1, n2, n_alpha, grid.shape[3]))
    return PhaseSpaceGrid(grid.half_widths, (n1, n2, n_alpha))


def within_error(
    p: Array, grid: PhaseSpaceGrid, s: float, coarser: Sequence[Solution]
) -> GridError:
    """Estimate the error of a density from runs on coarser grids.

    Compared are the probabilities of boxes of about the same probability, as tests do:
    what alternates from cell to cell is nothing that paths could show. The differences
    between three grids tell the order with which they fall, twice the geometric series
    of which is the estimate. It is at most that of order one, the order at a jump of
    the density, which two grids alone have to assume.

    Parameters
    ----------
    p : ndarray, shape grid.shape
    grid : PhaseSpaceGrid
    s : float
    coarser : sequence of Solution
        One or two runs, on grids that are ever coarser.
    """
    # Even numbers of cells: the three directions are not refined by quite the same.
    ratio = max(n / m for n, m in zip(grid.shape, coarser[0].grid.shape, strict=True))
    factor = 1.0 / (ratio - 1.0) if ratio > 1.0 else math.nan
    cells = [
        cell_probabilities(on_grid(run.density(s), run.grid, grid), grid)
        for run in coarser[:2]
    ]
    own = cell_probabilities(p, grid)
    labels = equal_probability_boxes(own, _BOXES, _LEAST_SHARE).ravel()
    change = _distance(labels, cells[0] - own)
    if len(cells) > 1:
        falls = change / max(_distance(labels, cells[1] - cells[0]), _TINY)
        if falls < 1.0:
            series = _CAUTION * falls / (1.0 - falls)
            factor = min(factor, max(series, _LEAST))
    return GridError(factor, factor * (cells[0] - own), factor * change)


def _distance(labels: NDArray[np.intp], change: Array) -> float:
    """L1 distance of the probabilities of boxes."""
    return float(np.abs(np.bincount(labels, change.ravel())).sum())


def start_noncentrality(law: DensityLaw) -> tuple[float, float]:
    """χ² distance and L1 distance of what is sampled from the values on the grid.

    Paths begin with the spline through the values, cut off below zero, the run with
    their trigonometric interpolant. N times the first is what it adds to a χ² test of
    the start, and at most what it adds later: the evolution contracts the distance.
    """
    own = cell_probabilities(np.asarray(law.p), law.grid)
    own, sampled = own / own.sum(), law.cell_shares()
    worst, distance = 0.0, 0.0
    for most in (_BOXES // 16, _BOXES):
        labels = equal_probability_boxes(own, most, _LEAST_SHARE).ravel()
        change = np.bincount(labels, (sampled - own).ravel())
        boxes = np.bincount(labels, own.ravel())
        worst = max(worst, float((change**2 / boxes).sum()))
        distance = max(distance, float(np.abs(change).sum()))
    return worst, distance


def on_grid(p: Array, coarser: PhaseSpaceGrid, grid: PhaseSpaceGrid) -> Array:
    """The trigonometric interpolant of a density at the centres of a finer grid."""
    for axis in range(3):
        n_coarse, n_fine = coarser.shape[axis], grid.shape[axis]
        # Centres in turns of the period.
        places = (np.arange(n_fine) + 0.5) / n_fine
        known = (np.arange(n_coarse) + 0.5) / n_coarse
        matrix = _dirichlet(places[:, None] - known[None, :], n_coarse)
        p = np.moveaxis(np.tensordot(matrix, p, (1, axis)), 0, axis)
    return p


def coarser_runs(
    solution: Solution,
    scheme: Scheme,
    law: Any,
    solve_options: Mapping[str, Any] | None = None,
) -> tuple[Solution, ...] | str:
    """Two runs of `scheme` from the law of the start, with the same steps.

    Returns
    -------
    tuple of Solution, or str
        Why there are none, if a scheme cannot be made or run on a coarser grid.
    """
    options = {
        "save_at": solution.saved_s.tolist(),
        "extrapolate": solution.errors is not None,
        **{**(solve_options or {}), **_LENIENT, "record_every": 10**9},
    }
    span, found = (0.0, float(solution.s[-1])), []
    grid: Any = scheme.grid
    try:
        for _ in range(2):
            grid = coarsened(grid)
            again = scheme_from_dict(describe_scheme(scheme), scheme.model, grid)
            with warnings.catch_warnings():
                # That the coarser grid is poor is what is looked at.
                warnings.simplefilter("ignore", UserWarning)
                start = _start(law, grid, scheme.model)
            run = solve(again, start, span, solution.ds, **options)
            found.append(without_curvature(run))
    except (FpsolveError, ValueError, TypeError) as error:
        return str(error)
    return tuple(found)


def _start(law: Any, grid: Any, model: Any) -> Array:
    """The density that a law has on a grid, of mass 1."""
    from fpsolve.paths.laws import DensityLaw

    if isinstance(grid, SmoothPhaseSpaceGrid):
        basic = _start(law, grid.phase_space, model)
        return with_curvature(basic, grid, model.curvature_variance)
    if isinstance(law, DensityLaw):
        density = law.density(grid)
    else:
        density, _ = density_and_law(law, grid)
    return np.asarray(density / diagnostics.mass(density, grid))


def _dirichlet(turns: Array, n: int) -> Array:
    """Weights of n equally spaced values, by their distance in turns."""
    with np.errstate(divide="ignore", invalid="ignore"):
        sine = np.sin(np.pi * turns)
        kernel = np.sin(n * np.pi * turns) / (n * sine)
        # The highest mode of an even number counts half on either side.
        kernel = kernel * np.cos(np.pi * turns) if n % 2 == 0 else kernel
    return np.asarray(np.where(np.abs(sine) < 1e-12, 1.0, kernel))
