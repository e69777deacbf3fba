"""The discrete phase space of a smooth fibre: position, angle and curvature."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array, check_floats
from fpsolve._support.checks import (
    check_integer,
    check_kind,
    check_positive,
    has_length,
    shown,
)
from fpsolve.grids.cells import CellGrid, cell_centres, checked_half_width
from fpsolve.grids.phase_space import PhaseSpaceGrid

__all__ = ["AnyGrid", "SmoothPhaseSpaceGrid", "check_smooth_grid"]

_AXES = ("n_xi1", "n_xi2", "n_alpha", "n_kappa")
_FEWEST_CELLS = 4
# Squares of curvatures are second moments.
_LARGEST = 1e100


@dataclass(frozen=True)
class SmoothPhaseSpaceGrid(CellGrid):
    """Cell centres (ξ1_i, ξ2_j, α_k) of a `PhaseSpaceGrid`, and κ_l between -Λ and Λ.

    κ_l = -Λ + (l + 1/2) dκ with dκ = 2Λ/n_kappa. A density is a C-contiguous float64
    array with ``p[i, j, k, l] = p(ξ1_i, ξ2_j, α_k, κ_l)``; its integral is the sum over
    the cells times `cell_volume`, spectrally accurate in α and κ.

    The curvature has the variance A²/(2R), plus that of the turn that the potential
    asks for, E (∇B·τ⊥)², where R is not small; five or six of its standard deviations
    are a half width, and a cell in κ must not be wider than √(A²/(2R)), better than two
    thirds of it. No argument has a default: each changes the mathematics.

    Parameters
    ----------
    half_width : float or (float, float)
        Half widths (L1, L2) of the ξ box; one number means L1 = L2.
    kappa_half_width : float
        Largest curvature Λ.
    shape : (int, int, int, int)
        Numbers of cells (n_xi1, n_xi2, n_alpha, n_kappa), each at least 4.

    Raises
    ------
    ValueError
        If a half width is not positive or a number of cells is below 4.
    TypeError
        If an argument is not a number, or a number of cells not an integer.
    """

    half_width: float | tuple[float, float]
    kappa_half_width: float
    shape: tuple[int, int, int, int]

    axes: ClassVar[tuple[str, ...]] = ("xi1", "xi2", "alpha", "kappa")

    def __post_init__(self) -> None:
        object.__setattr__(self, "half_width", checked_half_width(self.half_width))
        largest = check_positive("kappa_half_width", self.kappa_half_width)
        if not 1 / _LARGEST <= largest <= _LARGEST:
            raise ValueError(
                f"`kappa_half_width` must lie between {1 / _LARGEST:g} and "
                f"{_LARGEST:g}, got {largest:g}; curvatures are in units of the "
                "inverse throwing range."
            )
        object.__setattr__(self, "kappa_half_width", largest)
        object.__setattr__(self, "shape", _checked_shape(self.shape))

    @property
    def spacing(self) -> tuple[float, float, float, float]:
        """Cell widths (d1, d2, dα, dκ)."""
        width = 2 * self.kappa_half_width / self.shape[3]
        return (*self.phase_space.spacing, width)

    @property
    def cell_volume(self) -> float:
        """Volume d1 d2 dα dκ of a cell."""
        return math.prod(self.spacing)

    @cached_property
    def phase_space(self) -> PhaseSpaceGrid:
        """The same cells without the curvature."""
        return PhaseSpaceGrid(self.half_width, self.shape[:3])

    @property
    def alpha(self) -> Array:
        """Cell centres α_k in radians, shape (n_alpha,), read-only."""
        return self.phase_space.alpha

    @cached_property
    def kappa(self) -> Array:
        """Cell centres κ_l, shape (n_kappa,), read-only."""
        return cell_centres(-self.kappa_half_width, self.spacing[3], self.shape[3])

    def mesh(self) -> tuple[Array, ...]:
        """Cell centres (ξ1, ξ2, α, κ), which broadcast to the shape of the grid."""
        along = (self.xi1, self.xi2, self.alpha, self.kappa)
        return tuple(
            values.reshape([-1 if at == axis else 1 for at in range(4)])
            for axis, values in enumerate(along)
        )

    def plane(self) -> tuple[Array, Array]:
        """Cell centres (ξ1, ξ2) of the plane, shapes (n1, 1) and (1, n2)."""
        return self.xi1[:, None], self.xi2[None, :]

    def check(self, p: ArrayLike, name: str = "p") -> Array:
        """Return `p` as a C-contiguous float64 array of the shape of the grid.

        Raises
        ------
        TypeError
            If `p` does not hold floating-point numbers.
        GridMismatchError, ValueError
            If the shape differs, or only the curvature is missing.
        """
        if np.shape(check_floats(name, p)) == self.shape[:3]:
            raise ValueError(
                f"`{name}` must have a curvature, got one of (ξ, α) of shape "
                f"{self.shape[:3]}; initial.with_curvature(p, grid, "
                "model.curvature_variance) gives it that of a free fibre."
            )
        return super().check(p, name)

    def to_dict(self) -> dict[str, Any]:
        """Return the arguments as a JSON-able dictionary."""
        return {**super().to_dict(), "kappa_half_width": self.kappa_half_width}


# Where densities of the basic and of the smooth model live.
AnyGrid: TypeAlias = PhaseSpaceGrid | SmoothPhaseSpaceGrid


def check_smooth_grid(grid: Any, name: str = "grid") -> None:
    """Raise TypeError unless `grid` has a curvature."""
    remedy = "make one by SmoothPhaseSpaceGrid(half_width, kappa_half_width, shape)"
    check_kind(name, grid, SmoothPhaseSpaceGrid, remedy)


def _checked_shape(shape: Any) -> tuple[int, int, int, int]:
    if not has_length(shape, 4):
        raise ValueError(
            f"`shape` must be four integers ({', '.join(_AXES)}), got {shown(shape)}."
        )
    n_xi1, n_xi2, n_alpha, n_kappa = (
        check_integer(f"shape[{axis}] ({name})", n, _FEWEST_CELLS)
        for axis, (name, n) in enumerate(zip(_AXES, shape, strict=True))
    )
    return n_xi1, n_xi2, n_alpha, n_kappa
