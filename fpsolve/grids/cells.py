"""What a grid of cells in phase space and one in the plane have in common."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fpsolve._support.arrays import check_floats
from fpsolve._support.checks import check_call, check_positive, construct, has_length
from fpsolve.errors import GridMismatchError

__all__ = ["CellGrid", "cell_centres", "checked_half_width"]


# Half widths beyond this range overflow or underflow in moments.
_NARROWEST = 1e-30


class CellGrid(ABC):
    """Equal cells of a box around the origin; the first two directions are ξ1 and ξ2.

    Subclasses are frozen dataclasses with the fields `half_width` and `shape` that
    define `spacing` and `mesh`.
    """

    half_width: float | tuple[float, float]
    shape: tuple[int, ...]
    axes: ClassVar[tuple[str, ...]]

    @property
    @abstractmethod
    def spacing(self) -> tuple[float, ...]:
        """Widths of a cell."""

    @abstractmethod
    def mesh(self) -> tuple[NDArray[np.float64], ...]:
        """Cell centres, which broadcast to the shape of the grid."""

    @property
    def half_widths(self) -> tuple[float, float]:
        """Half widths (L1, L2)."""
        if isinstance(self.half_width, tuple):
            return self.half_width
        return self.half_width, self.half_width

    @property
    def n_cells(self) -> int:
        """Number of cells."""
        return math.prod(self.shape)

    @property
    def cell_area(self) -> float:
        """Area d1 d2 of a cell in the ξ plane."""
        return self.spacing[0] * self.spacing[1]

    @property
    def nbytes(self) -> int:
        """Memory of one density in bytes."""
        return self.n_cells * np.dtype(np.float64).itemsize

    @cached_property
    def xi1(self) -> NDArray[np.float64]:
        """Cell centres ξ1_i, shape (n_xi1,), read-only."""
        return cell_centres(-self.half_widths[0], self.spacing[0], self.shape[0])

    @cached_property
    def xi2(self) -> NDArray[np.float64]:
        """Cell centres ξ2_j, shape (n_xi2,), read-only."""
        return cell_centres(-self.half_widths[1], self.spacing[1], self.shape[1])

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
        array = check_floats(name, p)
        if array.shape != self.shape:
            raise GridMismatchError(self.shape, array.shape, name)
        return np.ascontiguousarray(array, dtype=np.float64)

    def evaluate(self, f: Callable[..., ArrayLike]) -> NDArray[np.float64]:
        """Values of f at the cell centres in a new array of the shape of the grid.

        Parameters
        ----------
        f : callable
            Called once with the arrays of `mesh`; its
            result may have any shape that broadcasts to that of the grid.

        Raises
        ------
        TypeError
            If the values are not real numbers.
        GridMismatchError
            If they do not broadcast to the shape of the grid.
        """
        check_call("f", f, f"f({', '.join(self.axes)})")
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
    def from_dict(cls, parameters: Mapping[str, Any]) -> Self:
        """Return the grid that `to_dict` described; ValueError for other names."""
        return construct(cls, "grid", parameters)


def cell_centres(start: float, step: float, n: int) -> NDArray[np.float64]:
    """Read-only centres of n cells of width `step` from `start` on."""
    centres = np.asarray(start + (np.arange(n) + 0.5) * step, dtype=np.float64)
    centres.flags.writeable = False
    return centres


def checked_half_width(half_width: Any) -> float | tuple[float, float]:
    """Return one float when both are equal, so that equal grids compare equal."""
    if not (isinstance(half_width, tuple | list) or np.ndim(half_width)):
        return _width(half_width)
    if not has_length(half_width, 2):
        raise ValueError(
            f"`half_width` must be one number or two, got {len(half_width)} of them."
        )
    width1, width2 = (_width(width) for width in half_width)
    return width1 if width1 == width2 else (width1, width2)


def _width(half_width: Any) -> float:
    width = check_positive("half_width", half_width)
    # Squares of it are areas and second moments.
    if not _NARROWEST <= width <= 1 / _NARROWEST:
        raise ValueError(
            f"`half_width` must lie between {_NARROWEST:g} and {1 / _NARROWEST:g}, got "
            f"{width:g}; lengths are in units of the throwing range."
        )
    return width
