"""Checks of arrays of numbers, with the wording that all functions share."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.checks import shown

__all__ = [
    "Array",
    "Complex",
    "check_answers",
    "check_finite_numbers",
    "check_floats",
    "check_numbers",
    "read_only",
]

# What most of the package is about, in the words of its signatures.
Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


def read_only(values: Array) -> Array:
    """The array itself, in which nothing can be written any more."""
    values.setflags(write=False)
    return values


def check_numbers(name: str, values: Any) -> Array:
    """Return `values` as a float64 array; TypeError when they are no real numbers.

    Integers and objects that are numbers pass; strings, booleans, complex numbers,
    None and rows of different lengths do not.
    """
    _refuse_masked(name, values)
    try:
        array = np.asarray(values)
        if array.dtype.kind == "O":
            _refuse_strange(array)
            array = array.astype(np.float64)
    except (TypeError, ValueError):
        raise TypeError(f"`{name}` must hold real numbers, got {shown(values)}.") from (
            None
        )
    # An empty list has the type of a float.
    if array.dtype.kind not in "iuf":
        raise TypeError(
            f"`{name}` must hold real numbers, got {shown(values)} ({array.dtype})."
        )
    return np.asarray(array, dtype=np.float64)


def check_answers(name: str, values: Any) -> Array:
    """As `check_numbers` for what a user's function returns: true and false count.

    They are 1 and 0: the average of an indicator is a probability.
    """
    if isinstance(values, bool | np.bool | np.ndarray):
        # Not `asarray`, which would forget what is masked.
        array = np.asanyarray(values)
        values = array.astype(np.float64) if array.dtype.kind == "b" else array
    return check_numbers(name, values)


def check_finite_numbers(name: str, values: Any) -> Array:
    """As `check_numbers`; ValueError for NaN or infinity, with its place."""
    array = check_numbers(name, values)
    if not np.isfinite(array).all():
        index = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        place = f" at index {index}" if index else ""
        raise ValueError(f"`{name}` must be finite, got {array[index]:g}{place}.")
    return array


def check_floats(name: str, values: Any) -> NDArray[np.floating[Any]]:
    """Return an array of floats, not copied; TypeError for any other kind.

    Densities are checked by this one: integers there are counts, or a mistake.
    """
    _refuse_masked(name, values)
    try:
        array = np.asarray(values)
    except ValueError:
        raise TypeError(
            f"`{name}` must be an array, got {shown(values)}; its rows differ in "
            "length."
        ) from None
    if not np.issubdtype(array.dtype, np.floating):
        raise TypeError(
            f"`{name}` must hold floating-point numbers, got {array.dtype}; convert "
            "it with `.astype(float)`."
        )
    return array


def _refuse_masked(name: str, values: Any) -> None:
    """TypeError for hidden numbers, which numpy would bring back without a word."""
    if isinstance(values, np.ma.MaskedArray) and np.ma.is_masked(values):
        raise TypeError(
            f"`{name}` must hold a number everywhere, got a masked array with "
            f"{np.ma.getmaskarray(values).sum()} of them hidden; fill it first."
        )


def _refuse_strange(array: NDArray[Any]) -> None:
    """TypeError for what numpy would turn into a number although it is none."""
    for value in array.flat:
        if value is None or isinstance(value, str | bytes | bool | complex):
            raise TypeError
