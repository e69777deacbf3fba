"""The ξ plane cut into cells: where densities of reduced models live."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.checks import check_integer, has_length, shown
from fpsolve.grids.cells import CellGrid, checked_half_width
from fpsolve.grids.phase_space import PhaseSpaceGrid

__all__ = ["PlaneGrid", "plane_of"]

_AXES = ("n_xi1", "n_xi2")
# Each cell needs a neighbour, or there is nothing to exchange.
_FEWEST_CELLS = 2


@dataclass(frozen=True)
class PlaneGrid(CellGrid):
    """Cell centres ξ1_i = -L1 + (i + 1/2) d1 and ξ2_j = -L2 + (j + 1/2) d2.

    The box [-L1, L1] x [-L2, L2] is closed: nothing flows through its walls, unlike
    that of a `PhaseSpaceGrid`, which is periodic. The cells are the same. A density
    is a C-contiguous float64 array with ``P[i, j] = P(ξ1_i, ξ2_j)``; its integral is
    the sum over the cells times `cell_area`.

    Parameters
    ----------
    half_width : float or (float, float)
        Half widths (L1, L2) of the box; one number means L1 = L2. No default: it
        changes the mathematics.
    shape : (int, int)
        Numbers of cells (n_xi1, n_xi2), each at least 2.

    Raises
    ------
    ValueError
        If a half width is not positive or a number of cells is below 2.
    TypeError
        If an argument is not a number, or a number of cells not an integer.
    """

    axes: ClassVar[tuple[str, ...]] = ("xi1", "xi2")

    half_width: float | tuple[float, float]
    shape: tuple[int, int]

    def __post_init__(self) -> None:
        object.__setattr__(self, "half_width", checked_half_width(self.half_width))
        object.__setattr__(self, "shape", _checked_plane_shape(self.shape))

    @classmethod
    def of(cls, grid: PhaseSpaceGrid) -> PlaneGrid:
        """The plane of a phase-space grid: the same cells in ξ, without the angle.

        Raises
        ------
        TypeError
            If `grid` is something else.
        """
        if not isinstance(grid, PhaseSpaceGrid):
            raise TypeError(
                f"`grid` must be a PhaseSpaceGrid, got {grid!r}; the angle needs "
                "cells too."
            )
        return cls(grid.half_width, grid.shape[:2])

    @property
    def spacing(self) -> tuple[float, float]:
        """Cell widths (d1, d2)."""
        (width1, width2), (n_xi1, n_xi2) = self.half_widths, self.shape
        return 2 * width1 / n_xi1, 2 * width2 / n_xi2

    def mesh(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Cell centres (ξ1, ξ2), shapes (n1, 1) and (1, n2); they broadcast."""
        return self.xi1[:, None], self.xi2[None, :]

    def refined(self) -> PlaneGrid:
        """The same box with twice the cells in each direction."""
        return PlaneGrid(self.half_width, (2 * self.shape[0], 2 * self.shape[1]))


def plane_of(grid: PlaneGrid | PhaseSpaceGrid) -> PlaneGrid:
    """The cells in ξ of either kind of grid."""
    if isinstance(grid, PhaseSpaceGrid):
        return PlaneGrid.of(grid)
    if not isinstance(grid, PlaneGrid):
        raise TypeError(
            f"`grid` must be a PlaneGrid or a PhaseSpaceGrid, got {grid!r}."
        )
    return grid


def _checked_plane_shape(shape: Any) -> tuple[int, int]:
    if not has_length(shape, 2):
        raise ValueError(
            f"`shape` must be two integers (n_xi1, n_xi2), got {shown(shape)}; take "
            "the plane of a phase-space grid with PlaneGrid.of(grid)."
        )
    n_xi1, n_xi2 = (
        check_integer(f"shape[{axis}] ({name})", n, _FEWEST_CELLS)
        for axis, (name, n) in enumerate(zip(_AXES, shape, strict=True))
    )
    return n_xi1, n_xi2
