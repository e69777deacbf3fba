"""The discrete phase space: cell centres, spacings, and what fits on them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.checks import check_integer, check_kind, has_length, shown
from fpsolve.grids.cells import CellGrid, cell_centres, checked_half_width

__all__ = ["PhaseSpaceGrid", "check_grid"]

_AXES = ("n_xi1", "n_xi2", "n_alpha")
# Four cells are what a cubic interpolant needs; below that no scheme works.
_FEWEST_CELLS = 4


@dataclass(frozen=True)
class PhaseSpaceGrid(CellGrid):
    """Cell centres ξ1_i = -L1 + (i + 1/2) d1, likewise ξ2_j, and α_k = (k + 1/2) dα.

    The box is [-L1, L1) x [-L2, L2) x [0, 2π), periodic in all three directions. A
    density is a C-contiguous float64 array with ``p[i, j, k] = p(ξ1_i, ξ2_j, α_k)``.
    No cell centre lies at the origin when the numbers of cells are even, which keeps
    the kink of B = ‖ξ‖ off the nodes. Grids are equal when their numbers are.

    Neither argument has a default: both change the mathematics. The box is wide
    enough when the boundary mass of a run stays negligible; the quadratic potential
    with σ = 1 loses about exp(-L²/2), the linear one (1 + L) exp(-L).

    Parameters
    ----------
    half_width : float or (float, float)
        Half widths (L1, L2) of the ξ box; one number means L1 = L2.
    shape : (int, int, int)
        Numbers of cells (n_xi1, n_xi2, n_alpha), each at least 4.

    Raises
    ------
    ValueError
        If a half width is not positive or a number of cells is below 4.
    TypeError
        If an argument is not a number, or a number of cells not an integer.
    """

    axes: ClassVar[tuple[str, ...]] = ("xi1", "xi2", "alpha")

    half_width: float | tuple[float, float]
    shape: tuple[int, int, int]

    def __post_init__(self) -> None:
        object.__setattr__(self, "half_width", checked_half_width(self.half_width))
        object.__setattr__(self, "shape", _checked_shape(self.shape))

    def __eq__(self, other: object) -> bool:
        """Grids are equal when their numbers are, whatever proposed them."""
        if not isinstance(other, PhaseSpaceGrid):
            return NotImplemented
        return (self.half_widths, self.shape) == (other.half_widths, other.shape)

    def __hash__(self) -> int:
        return hash((self.half_widths, self.shape))

    @property
    def spacing(self) -> tuple[float, float, float]:
        """Cell widths (d1, d2, dα), the last in radians."""
        (width1, width2), (n_xi1, n_xi2, n_alpha) = self.half_widths, self.shape
        return 2 * width1 / n_xi1, 2 * width2 / n_xi2, 2 * math.pi / n_alpha

    @cached_property
    def cell_volume(self) -> float:
        """Volume d1 d2 dα of a cell."""
        return math.prod(self.spacing)

    @cached_property
    def alpha(self) -> NDArray[np.float64]:
        """Cell centres α_k in radians, shape (n_alpha,), read-only."""
        return cell_centres(0.0, self.spacing[2], self.shape[2])

    def mesh(
        self,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Cell centres (ξ1, ξ2, α), shapes (n1, 1, 1), (1, n2, 1) and (1, 1, n_alpha).

        They broadcast to the shape of the grid.
        """
        return (
            self.xi1[:, None, None],
            self.xi2[None, :, None],
            self.alpha[None, None, :],
        )

    def plane(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Cell centres (ξ1, ξ2) of the plane, shapes (n1, 1) and (1, n2)."""
        return self.xi1[:, None], self.xi2[None, :]


def check_grid(grid: Any, name: str = "grid") -> None:
    """Raise TypeError unless `grid` is one of phase space."""
    remedy = "make one by PhaseSpaceGrid(half_width, shape)"
    check_kind(name, grid, PhaseSpaceGrid, remedy)


def _checked_shape(shape: Any) -> tuple[int, int, int]:
    if not has_length(shape, 3):
        raise ValueError(
            f"`shape` must be three integers (n_xi1, n_xi2, n_alpha), got "
            f"{shown(shape)}."
        )
    n_xi1, n_xi2, n_alpha = (
        check_integer(f"shape[{axis}] ({name})", n, _FEWEST_CELLS)
        for axis, (name, n) in enumerate(zip(_AXES, shape, strict=True))
    )
    return n_xi1, n_xi2, n_alpha
