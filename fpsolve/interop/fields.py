"""Densities as fields of py-pde, and back."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pde
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.plane import PlaneGrid

__all__ = ["cartesian_grid", "from_pde_field", "own_grid", "to_pde_field"]


# Bounds that were computed rather than typed may differ by rounding.
ROUNDING = 1e-12


def to_pde_field(
    p: ArrayLike, grid: PhaseSpaceGrid | PlaneGrid, label: str | None = None
) -> Any:
    """p[i, j, k] as a `pde.ScalarField` on the same cells.

    Cells are centred in both packages, so the values are copied bit by bit. The
    axes x, y, z of the field are ξ₁, ξ₂, α.

    Parameters
    ----------
    p : array_like, shape grid.shape
        A density on phase space, (n1, n2, n_alpha), or on the plane, (n1, n2).
    grid : PhaseSpaceGrid or PlaneGrid
        Becomes a `pde.CartesianGrid`: periodic in all three directions, or closed
        in both.
    label : str, optional
        Name of the field in plots and files.

    Returns
    -------
    pde.ScalarField

    Raises
    ------
    TypeError
        If `grid` is another kind of grid, or `p` does not hold floating-point numbers.
    GridMismatchError
        If the shapes differ.
    """
    field_grid = cartesian_grid(grid)
    return pde.ScalarField(field_grid, grid.check(p, "p"), label=label)


def from_pde_field(field: Any) -> tuple[Array, PhaseSpaceGrid | PlaneGrid]:
    """The values of a `pde.ScalarField` as an array, and the grid they belong to.

    Parameters
    ----------
    field : pde.ScalarField
        On a `pde.CartesianGrid` with the box [-L1, L1] x [-L2, L2] x [0, 2π],
        periodic, or [-L1, L1] x [-L2, L2], not periodic.

    Returns
    -------
    p : ndarray
        A C-contiguous copy.
    grid : PhaseSpaceGrid or PlaneGrid

    Raises
    ------
    TypeError
        If `field` is no real scalar field or its grid is not Cartesian.
    ValueError
        If the box or its periodicity is another.
    """
    if not isinstance(field, pde.ScalarField):
        raise TypeError(
            f"`field` must be a pde.ScalarField, got {type(field).__name__}; take a "
            "component of a vector, or a member of a collection."
        )
    if np.iscomplexobj(field.data):
        raise TypeError("`field` must be real, got complex; take its real part.")
    grid = own_grid(field.grid)
    return np.array(field.data, dtype=np.float64, order="C"), grid


def cartesian_grid(grid: PhaseSpaceGrid | PlaneGrid) -> Any:
    """The `pde.CartesianGrid` with the same cells."""
    if not isinstance(grid, PhaseSpaceGrid | PlaneGrid):
        raise TypeError(
            f"`grid` must be a PhaseSpaceGrid or a PlaneGrid, got {grid!r}; "
            "from_pde_field goes the other way."
        )
    bounds = [(-width, width) for width in grid.half_widths]
    periodic = isinstance(grid, PhaseSpaceGrid)
    if periodic:
        bounds.append((0.0, 2 * math.pi))
    return pde.CartesianGrid(bounds, grid.shape, periodic=periodic)


def own_grid(grid: Any) -> PhaseSpaceGrid | PlaneGrid:
    """The grid of this package with the cells of a `pde.CartesianGrid`.

    Raises
    ------
    TypeError
        If the grid is not Cartesian.
    ValueError
        If it has neither two nor three axes, or its box or periodicity is another.
    """
    if not isinstance(grid, pde.CartesianGrid):
        raise TypeError(
            f"`field.grid` must be a pde.CartesianGrid, got {type(grid).__name__}; "
            "to_pde_field makes one."
        )
    if grid.num_axes not in (2, 3):
        raise ValueError(
            "`field.grid` must have the axes (ξ₁, ξ₂) or (ξ₁, ξ₂, α), got "
            f"{grid.num_axes} of them."
        )
    _check_periodicity(grid)
    half_width = _half_widths(grid)
    if grid.num_axes == 2:
        return PlaneGrid(half_width, grid.shape)
    _check_angle(grid.axes_bounds[2])
    return PhaseSpaceGrid(half_width, grid.shape)


def _check_periodicity(grid: Any) -> None:
    expected = grid.num_axes == 3
    if any(periodic != expected for periodic in grid.periodic):
        rule = "periodic along all of ξ₁, ξ₂, α" if expected else "closed, not periodic"
        raise ValueError(
            f"`field.grid` must be {rule}, got periodic = {list(grid.periodic)}; pass "
            f"periodic={expected} to CartesianGrid."
        )


def _half_widths(grid: Any) -> tuple[float, float]:
    for lower, upper in grid.axes_bounds[:2]:
        if not abs(lower + upper) <= ROUNDING * (upper - lower):
            raise ValueError(
                "`field.grid` must be centred, -L to L along ξ₁ and ξ₂, got "
                f"{lower:g} to {upper:g}; shift its bounds."
            )
    (_, width1), (_, width2) = grid.axes_bounds[:2]
    return float(width1), float(width2)


def _check_angle(bounds: tuple[float, float]) -> None:
    lower, upper = bounds
    if not (abs(lower) <= ROUNDING and abs(upper - 2 * math.pi) <= 7 * ROUNDING):
        raise ValueError(
            f"`field.grid` must extend over α from 0 to 2π, got {lower:g} to "
            f"{upper:g}; angles are in radians."
        )
