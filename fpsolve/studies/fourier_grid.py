"""A grid for Fourier translations, chosen by the errors of trial runs on it."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_real
from fpsolve.density.schemes.drift_kick import DriftKick
from fpsolve.density.solution import Solution
from fpsolve.density.solve import solve
from fpsolve.density.suggestions import check_tolerance, suggest_step
from fpsolve.density.unresolved import unresolved_by_axis
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel, check_model
from fpsolve.studies.explained_grid import (
    BOX_SHARE,
    SuggestedGrid,
    box_half_widths,
    check_normalisable,
    share_outside,
)

__all__ = ["suggest_fourier_grid"]

FIRST_SHAPE = (24, 24, 16)
# L1 error of the steps of a trial. Trials share it, so that it leaves their difference.
TRIAL_ERROR = 0.1
# Part of the tolerance that the shortest waves may hold, and that two grids may differ
# by: the rest is for the steps of the run.
WAVES_SHARE, PAIR_SHARE = 1 / 4, 1 / 4
# Factors by which cells and boxes grow, and those of the second grid of a pair.
MORE, WIDER, FINER, BEYOND = 1.2, 1.15, 1.5, 1.2
# Where waves are too high by so much the cells grow by more.
FAR, MUCH_MORE = 100.0, 1.5
# Cells of the larger grid of a pair, 0.5 GiB a density.
MOST_CELLS = 2**26


def suggest_fourier_grid(
    model: LayDownModel,
    initial: Callable[[PhaseSpaceGrid], Array],
    s_end: float,
    tolerance: float = 1e-6,
) -> SuggestedGrid:
    """Box and cells whose measured L1 error is below `tolerance`, for Fourier.

    What `solve(tolerance=)` needs with ``drift_kick(..., translation="fourier")``.
    Trial runs of the start to `s_end`, with long steps, on more and more cells: until
    the shortest waves of start and densities hold a quarter of the tolerance at most
    and a tenth of it lies in the outermost cells; then until the densities differ by
    no more than a quarter of it from those on cells finer by a half in a box wider by
    a fifth. Steps are equal on both grids, so their error is not in the difference.

    Parameters
    ----------
    model : LayDownModel
        Its e^{−B} must be normalisable.
    initial : callable
        ``initial(grid)`` is the start on any grid.
    s_end : float
        Length of the run.
    tolerance : float
        L1 error that box and cells may leave.

    Returns
    -------
    SuggestedGrid
        `.reason` says what was measured.

    Raises
    ------
    TypeError, ValueError
        If an argument is none of these, or the start is too sharp: the cells would not
        fit into memory.
    """
    check_model(model)
    check_tolerance(tolerance)
    check_normalisable(model)
    s_end = check_real("s_end", s_end)
    if not 0 < s_end < math.inf:
        raise ValueError(
            f"`s_end` must be positive and finite, got {s_end:g}; it is the length of "
            "the run."
        )
    lost = share_outside(tolerance)
    half1, half2 = box_half_widths(model.potential, lost)
    grid = PhaseSpaceGrid((half1, half2), FIRST_SHAPE)
    while True:
        grid, waves, outside = _resolving(model, initial, s_end, tolerance, grid)
        difference = _difference(model, initial, s_end, grid)
        if difference <= PAIR_SHARE * tolerance:
            break
        grid = _grown(grid, np.full(3, MORE), WIDER)
    reason = (
        f"in trial runs to s = {s_end:g} the shortest waves hold {waves:.1e}, the "
        f"outermost cells {outside:.1e}, and densities differ by {difference:.1e} from "
        f"those on cells finer by {FINER:g} in a box wider by {BEYOND:g}; "
        f"{tolerance:g} is aimed at."
    )
    return SuggestedGrid.because(grid.half_widths, grid.shape, reason)


def _resolving(
    model: LayDownModel, initial: Any, s_end: float, tolerance: float,
    grid: PhaseSpaceGrid,
) -> tuple[PhaseSpaceGrid, float, float]:  # fmt: skip
    """The first of growing grids that tells of no error; its waves, and what is out."""
    while True:
        solution = _trial(model, initial, s_end, grid)
        waves = np.max([unresolved_by_axis(p, grid) for p in solution.densities], 0)
        outside = float(solution.boundary_mass.max())
        wide = outside <= BOX_SHARE * tolerance
        allowed = WAVES_SHARE * tolerance
        if wide and waves.sum() <= allowed:
            return grid, float(waves.sum()), outside
        # NaN asks for more cells, which end in a refusal.
        more = np.where(waves <= FAR * allowed, MORE, MUCH_MORE)
        more[waves <= allowed / 3] = 1.0
        grid = _grown(grid, more, 1.0 if wide else WIDER)


def _grown(grid: PhaseSpaceGrid, more: Array, wider: float) -> PhaseSpaceGrid:
    """So many times more cells by direction, and a wider box of the same cells."""
    factors = more * np.array([wider, wider, 1.0])
    half1, half2 = grid.half_widths
    n1, n2, n_alpha = (
        n if factor == 1.0 else 4 * math.ceil(n * factor / 4)
        for n, factor in zip(grid.shape, factors, strict=True)
    )
    return PhaseSpaceGrid((half1 * wider, half2 * wider), (n1, n2, n_alpha))


def _finer(grid: PhaseSpaceGrid) -> PhaseSpaceGrid:
    """The other grid of a pair."""
    half1, half2 = grid.half_widths
    factors = (FINER * BEYOND, FINER * BEYOND, FINER)
    n1, n2, n_alpha = (
        2 * math.ceil(n * factor / 2)
        for n, factor in zip(grid.shape, factors, strict=True)
    )
    return PhaseSpaceGrid((half1 * BEYOND, half2 * BEYOND), (n1, n2, n_alpha))


def _trial(
    model: LayDownModel, initial: Any, s_end: float, grid: PhaseSpaceGrid
) -> Solution:
    """A run with long steps, of which nothing is asked but densities and boundary."""
    ds = float(suggest_step(model, grid, TRIAL_ERROR))
    n_steps = 4 * math.ceil(s_end / (4 * ds))
    _check_cells(_finer(grid))
    with warnings.catch_warnings():
        # That a start is too sharp for its cells is what a trial is to find.
        warnings.simplefilter("ignore", UserWarning)
        p0 = initial(grid)
    return solve(
        DriftKick(model, grid, translation="fourier"), p0, (0.0, s_end),
        s_end / n_steps, save_at=s_end / 4 * np.arange(5), boundary_tolerance=1.0,
        negative_tolerance=math.inf, entropy_tolerance=math.inf,
        circulation_tolerance=math.inf,
    )  # fmt: skip


def _difference(
    model: LayDownModel, initial: Any, s_end: float, grid: PhaseSpaceGrid
) -> float:
    """The largest L1 distance of densities from those on the other grid of the pair."""
    finer = _finer(grid)
    pair = (_trial(model, initial, s_end, one).densities for one in (grid, finer))
    distances = [
        float(np.abs(p - _read(q, finer, grid)).sum()) * grid.cell_volume
        for p, q in zip(*pair, strict=True)
    ]
    return max(distances)


def _read(p: Array, grid: PhaseSpaceGrid, at: PhaseSpaceGrid) -> Array:
    """The trigonometric interpolant of p at the centres of another grid."""
    places = ((at.xi1, grid.xi1), (at.xi2, grid.xi2), (at.alpha, grid.alpha))
    for axis, (wanted, given) in enumerate(places):
        turns = (wanted[:, None] - given[None, :]) * (2 * np.pi / given.size)
        matrix = _dirichlet(turns / grid.spacing[axis], given.size)
        p = np.moveaxis(np.tensordot(matrix, p, (1, axis)), 0, axis)
    return p


def _dirichlet(angles: Array, n: int) -> Array:
    """(1 + 2 Σ cos kx)/n over the waves that n cells tell apart."""
    modes = np.arange(1, (n + 1) // 2)
    return np.asarray((1 + 2 * np.cos(angles[..., None] * modes).sum(axis=-1)) / n)


def _check_cells(grid: PhaseSpaceGrid) -> None:
    """Raise if a trial is beyond most machines."""
    if not math.prod(grid.shape) <= MOST_CELLS:
        n1, n2, n_alpha = grid.shape
        raise ValueError(
            "`initial` must be smooth for Fourier translations, got one that needs "
            f"more than {n1} x {n2} x {n_alpha} cells; raise `tolerance`, or take "
            'translation="lagrange".'
        )
