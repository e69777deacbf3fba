"""How far one variable of two results is apart, and whether errors explain it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["FLOOR", "Difference", "difference_of", "same_bits"]


# Quantities are of order one: below this they are rounding, whatever their own size.
FLOOR = 1e-12


@dataclass(frozen=True)
class Difference:
    """|b − a| of one variable: the largest, where it is, and in units of its error.

    Attributes
    ----------
    name : str
    equal : bool
        Whether both have the same bits everywhere.
    largest : float
        max |b − a|; infinite if only one of both is a number, or texts differ.
    scale : float
        max |a|, the largest value.
    place : dict
        Coordinates of the largest difference.
    in_errors : float or None
        max |b − a|/error, error being the sum of the two estimated errors, or the root
        of the sum of squares of two standard errors; None without errors.
    statistical : bool
        Whether they are standard errors.
    n : int
        Numbers compared.
    """

    name: str
    equal: bool
    largest: float
    scale: float
    place: Mapping[str, Any] = field(default_factory=dict)
    in_errors: float | None = None
    statistical: bool = False
    n: int = 1

    @property
    def relative(self) -> float:
        """max |b − a| over max |a|; 0 where nothing differs."""
        if not self.largest:
            return 0.0
        return self.largest / self.scale if self.scale else float("inf")

    @property
    def within_errors(self) -> bool | None:
        """Whether the estimated errors of both add up to more; None without any."""
        if self.in_errors is None or self.statistical:
            return None
        return self.in_errors <= 1.0 or self.largest <= FLOOR

    def within(self, tolerance: float) -> bool:
        """Whether max |b − a| <= tolerance max |a|, or 1e-12."""
        return self.largest <= max(tolerance * self.scale, FLOOR)


def difference_of(
    name: str, a: xr.DataArray, b: xr.DataArray, error: Array | None, statistical: bool
) -> Difference:
    """Compare one variable of two results, on the same places.

    Parameters
    ----------
    name : str
    a, b : DataArray
    error : ndarray or None
        Of the difference.
    statistical : bool
    """
    equal = same_bits(a.to_numpy(), b.to_numpy())
    if a.dtype.kind not in "biuf" or b.dtype.kind not in "biuf":
        return Difference(name, equal, 0.0 if equal else np.inf, 0.0, n=a.size)
    apart = distance(a.to_numpy(), b.to_numpy())
    place = np.unravel_index(int(np.argmax(apart)), apart.shape) if apart.size else ()
    return Difference(
        name,
        equal,
        float(apart.max(initial=0.0)),
        float(np.abs(a.to_numpy()[np.isfinite(a.to_numpy())]).max(initial=0.0)),
        {} if equal else _coordinates(a, place),
        None if error is None else _in_units(apart, error),
        statistical,
        a.size,
    )


def distance(a: NDArray[Any], b: NDArray[Any]) -> Array:
    """|b − a|: zero for what is the same, NaN included, infinite for what has none."""
    a, b = a.astype(np.float64), b.astype(np.float64)
    same = (a == b) | (np.isnan(a) & np.isnan(b))
    with np.errstate(all="ignore"):
        apart = np.abs(b - a)
    return np.where(same, 0.0, np.where(np.isnan(apart), np.inf, apart))


def same_bits(a: NDArray[Any], b: NDArray[Any]) -> bool:
    """Whether two arrays hold the same, NaN and the sign of zero included."""
    if a.shape != b.shape:
        return False
    if a.dtype.kind == b.dtype.kind == "f":
        return a.dtype == b.dtype and a.tobytes() == b.tobytes()
    if "O" in (a.dtype.kind, b.dtype.kind) or "U" in (a.dtype.kind, b.dtype.kind):
        return list(map(str, a.ravel())) == list(map(str, b.ravel()))
    return bool(np.array_equal(a, b))


def _in_units(apart: Array, error: Array) -> float:
    with np.errstate(all="ignore"):
        ratio = np.where(apart == 0.0, 0.0, apart / error)
    return float(np.nan_to_num(ratio, nan=np.inf).max(initial=0.0))


def _coordinates(a: xr.DataArray, place: tuple[Any, ...]) -> dict[str, Any]:
    found = {}
    for dimension, index in zip(a.dims, place, strict=True):
        name = str(dimension)
        value = a[name].to_numpy()[index] if name in a.coords else int(index)
        found[name] = value.item() if isinstance(value, np.generic) else value
    return found
