"""Grids of phase space from dictionaries, and from the numbers that a file gives."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.smooth import AnyGrid, SmoothPhaseSpaceGrid

__all__ = ["grid_from_dict", "make_grid"]


def grid_from_dict(parameters: Mapping[str, Any]) -> Any:
    """Return the grid that `to_dict` described; ValueError for other names."""
    if "kappa_half_width" in parameters:
        return SmoothPhaseSpaceGrid.from_dict(parameters)
    return PhaseSpaceGrid.from_dict(parameters)


def make_grid(
    half_width: float | tuple[float, float],
    shape: tuple[int, int, int],
    kappa_half_width: float | None = None,
    n_kappa: int | None = None,
) -> AnyGrid:
    """Return the grid with a curvature if there are numbers for it, else without.

    Raises
    ------
    ValueError
        If only one of the two is given, or a number is none of a grid.
    """
    if kappa_half_width is None and n_kappa is None:
        return PhaseSpaceGrid(half_width, shape)
    if kappa_half_width is None or n_kappa is None:
        raise ValueError(
            "`kappa_half_width` and `n_kappa` must be given together, got one of them."
        )
    return SmoothPhaseSpaceGrid(half_width, kappa_half_width, (*shape, n_kappa))
