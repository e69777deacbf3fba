"""What the cells do not resolve, told by the shortest waves of a density."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array, read_only
from fpsolve.density.solution import Solution
from fpsolve.grids.phase_space import PhaseSpaceGrid

__all__ = ["cells_error", "unresolved", "unresolved_by_axis"]

# Wave numbers that are looked at, the shortest of every direction.
_SHORTEST = 2


def cells_error(solution: Solution) -> Array:
    """The L1 errors that the cells leave in saved densities; shape (n_saved,).

    What a density shows, and the square of what the start shows: noise damps its short
    waves, but those beyond them, about as much smaller again, are taken for long ones
    by the cells. Zero unless the translation is that of the trigonometric interpolant:
    of piecewise interpolation the short waves say little.
    """
    densities, grid = solution.densities, solution.grid
    if solution.scheme["options"].get("translation") != "fourier":
        return np.zeros(len(densities))
    start: Any = solution.initial_density
    first = unresolved(start, grid)
    mass = float(start.sum()) * grid.cell_volume
    return np.array([unresolved(p, grid) + first * (first / mass) for p in densities])


def unresolved(p: Array, grid: PhaseSpaceGrid) -> float:
    """Σ over ξ₁, ξ₂, α of ∫ |amplitudes| of the two shortest waves that a cell tells.

    Amplitudes fall from wave to wave where a density is smooth, faster than any power,
    so these are larger than all that is missing: a few times the L1 error against runs
    on finer cells (`validation/performance/levels.py` prints the range).
    """
    return float(unresolved_by_axis(p, grid).sum())


def unresolved_by_axis(p: Array, grid: PhaseSpaceGrid) -> Array:
    """The terms of `unresolved`; shape (3,)."""
    terms = []
    for axis, n in enumerate(p.shape):
        rows = waves(n)
        others = (other for other in range(p.ndim) if other != axis)
        along = p.transpose(axis, *others).reshape(n, -1)
        terms.append(float(np.abs(rows @ along).sum()))
    return np.array(terms) * grid.cell_volume


@lru_cache(maxsize=16)
def waves(n: int) -> Array:
    """Rows that give the amplitudes of the shortest waves on n cells, times n.

    Of the unmatched wave of an even n only the sine lives at cell centres. Read-only.
    """
    centres = (np.arange(n) + 0.5) * (2 * np.pi / n)
    rows = []
    for mode in range(n // 2 - _SHORTEST + 1, n // 2 + 1):
        unmatched = 2 * mode == n
        rows.append(np.sin(mode * centres) * (1.0 if unmatched else 2.0))
        if not unmatched:
            rows.append(2.0 * np.cos(mode * centres))
    return read_only(np.array(rows))
