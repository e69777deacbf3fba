"""The discrete phase space: cell centres, spacings, and what fits on them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fpsolve._checks import check_integer, check_positive, construct
from fpsolve.errors import GridMismatchError

__all__ = ["PhaseSpaceGrid"]

_AXES = ("n_xi1", "n_xi2", "n_alpha")
# Four cells are what a cubic interpolant needs; below that no scheme works.
_FEWEST_CELLS = 4


@dataclass(frozen=True)
class PhaseSpaceGrid:
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

    half_width: float | tuple[float, float]
    shape: tuple[int, int, int]

    def __post_init__(self) -> None:
        object.__setattr__(self, "half_width", _checked_half_width(self.half_width))
        object.__setattr__(self, "shape", _checked_shape(self.shape))

    def __eq__(self, other: object) -> bool:
        """Grids are equal when their numbers are, whatever proposed them."""
        if not isinstance(other, PhaseSpaceGrid):
            return NotImplemented
        return (self.half_widths, self.shape) == (other.half_widths, other.shape)

    def __hash__(self) -> int:
        return hash((self.half_widths, self.shape))

    @property
    def half_widths(self) -> tuple[float, float]:
        """Half widths (L1, L2)."""
        if isinstance(self.half_width, tuple):
            return self.half_width
        return self.half_width, self.half_width

    @property
    def spacing(self) -> tuple[float, float, float]:
        """Cell widths (d1, d2, dα), the last in radians."""
        (width1, width2), (n_xi1, n_xi2, n_alpha) = self.half_widths, self.shape
        return 2 * width1 / n_xi1, 2 * width2 / n_xi2, 2 * math.pi / n_alpha

    @property
    def n_cells(self) -> int:
        """Number of cells."""
        return math.prod(self.shape)

    @property
    def cell_area(self) -> float:
        """Area d1 d2 of a cell in the ξ plane."""
        return self.spacing[0] * self.spacing[1]

    @property
    def cell_volume(self) -> float:
        """Volume d1 d2 dα of a cell."""
        return math.prod(self.spacing)

    @property
    def nbytes(self) -> int:
        """Memory of one density in bytes."""
        return self.n_cells * np.dtype(np.float64).itemsize

    @cached_property
    def xi1(self) -> NDArray[np.float64]:
        """Cell centres ξ1_i, shape (n_xi1,), read-only."""
        return _centres(-self.half_widths[0], self.spacing[0], self.shape[0])

    @cached_property
    def xi2(self) -> NDArray[np.float64]:
        """Cell centres ξ2_j, shape (n_xi2,), read-only."""
        return _centres(-self.half_widths[1], self.spacing[1], self.shape[1])

    @cached_property
    def alpha(self) -> NDArray[np.float64]:
        """Cell centres α_k in radians, shape (n_alpha,), read-only."""
        return _centres(0.0, self.spacing[2], self.shape[2])

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

    def check(self, p: ArrayLike, name: str = "p") -> NDArray[np.float64]:
        """Return `p` as a C-contiguous float64 array of the shape of the grid.

        The array itself comes back, not a copy, when it already is one.

        Raises
        ------
        TypeError
            If `p` does not hold floating-point numbers.
        GridMismatchError
            If the shape differs; it is also a `ValueError`.
        """
        array = np.asarray(p)
        if not np.issubdtype(array.dtype, np.floating):
            raise TypeError(
                f"`{name}` must hold floating-point numbers, got {array.dtype}; "
                "convert it with `.astype(float)`."
            )
        if array.shape != self.shape:
            raise GridMismatchError(self.shape, array.shape, name)
        return np.ascontiguousarray(array, dtype=np.float64)

    def evaluate(self, f: Callable[..., ArrayLike]) -> NDArray[np.float64]:
        """Values f(ξ1_i, ξ2_j, α_k) in a new array of the shape of the grid.

        Parameters
        ----------
        f : callable
            Called once as ``f(xi1, xi2, alpha)`` with the arrays of `mesh`; its
            result may have any shape that broadcasts to that of the grid.

        Raises
        ------
        TypeError
            If the values are not real numbers.
        GridMismatchError
            If they do not broadcast to the shape of the grid.
        """
        values = np.asarray(f(*self.mesh()))
        if values.dtype.kind not in "fiub":
            raise TypeError(f"`f` must return real numbers, got {values.dtype}.")
        try:
            return np.broadcast_to(values, self.shape).astype(np.float64, order="C")
        except ValueError:
            raise GridMismatchError(self.shape, values.shape, "f") from None

    def to_dict(self) -> dict[str, Any]:
        """Return the arguments as a JSON-able dictionary."""
        return {"half_width": list(self.half_widths), "shape": list(self.shape)}

    @classmethod
    def from_dict(cls, parameters: Mapping[str, Any]) -> PhaseSpaceGrid:
        """Return the grid that `to_dict` described; ValueError for other names."""
        return construct(cls, "grid", parameters)


def _centres(start: float, step: float, n: int) -> NDArray[np.float64]:
    centres = np.asarray(start + (np.arange(n) + 0.5) * step, dtype=np.float64)
    centres.flags.writeable = False
    return centres


def _checked_half_width(half_width: Any) -> float | tuple[float, float]:
    """Return one float when both are equal, so that equal grids compare equal."""
    if np.ndim(half_width) == 0:
        return check_positive("half_width", half_width)
    if len(half_width) != 2:
        raise ValueError(
            f"`half_width` must be one number or two, got {len(half_width)} of them."
        )
    width1, width2 = (check_positive("half_width", width) for width in half_width)
    return width1 if width1 == width2 else (width1, width2)


def _checked_shape(shape: Any) -> tuple[int, int, int]:
    if np.ndim(shape) != 1 or len(shape) != 3:
        raise ValueError(
            f"`shape` must be three integers (n_xi1, n_xi2, n_alpha), got {shape!r}."
        )
    n_xi1, n_xi2, n_alpha = (
        check_integer(f"shape[{axis}] ({name})", n, _FEWEST_CELLS)
        for axis, (name, n) in enumerate(zip(_AXES, shape, strict=True))
    )
    return n_xi1, n_xi2, n_alpha
