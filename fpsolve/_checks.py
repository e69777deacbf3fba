"""Checks of scalar arguments, with the wording that all constructors share.

Each returns the argument as a plain `float` or `int`, so that equality, hashing and
JSON do not depend on the kind of number a caller had at hand. Comparisons are written
so that NaN fails.
"""

from __future__ import annotations

import inspect
import math
import operator
from collections.abc import Mapping
from typing import Any, TypeVar

__all__ = [
    "check_finite",
    "check_integer",
    "check_non_negative",
    "check_positive",
    "check_real",
    "construct",
]

T = TypeVar("T")


def check_real(name: str, value: Any) -> float:
    """Return `value` as a float; TypeError when it is not a real number."""
    try:
        if isinstance(value, str | bytes | bool):
            raise TypeError
        return float(value)
    except (TypeError, ValueError):
        raise TypeError(f"`{name}` must be a real number, got {value!r}.") from None


def check_finite(name: str, value: Any) -> float:
    """Return `value` as a float; ValueError when it is NaN or infinite."""
    number = check_real(name, value)
    if not math.isfinite(number):
        raise ValueError(f"`{name}` must be finite, got {number:g}.")
    return number


def check_positive(name: str, value: Any, remedy: str = "") -> float:
    """Return `value` as a float; ValueError unless 0 < value < infinity."""
    number = check_real(name, value)
    if not 0 < number < math.inf:
        raise ValueError(
            f"`{name}` must be positive and finite, got {number:g}{remedy}."
        )
    return number


def check_non_negative(name: str, value: Any, remedy: str = "") -> float:
    """Return `value` as a float; ValueError unless 0 <= value < infinity."""
    number = check_real(name, value)
    if not 0 <= number < math.inf:
        raise ValueError(
            f"`{name}` must be non-negative and finite, got {number:g}{remedy}."
        )
    return number


def check_integer(name: str, value: Any, at_least: int) -> int:
    """Return `value` as an int; ValueError when it is below `at_least`."""
    try:
        if isinstance(value, bool):
            raise TypeError
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"`{name}` must be an integer, got {value!r}.") from None
    if number < at_least:
        raise ValueError(f"`{name}` must be at least {at_least}, got {number}.")
    return number


def construct(target: type[T], name: str, parameters: Mapping[str, Any]) -> T:
    """Return target(**parameters); ValueError when the names do not fit.

    Parameters come from files here, so a misspelt one is a wrong value, not a
    programming error.
    """
    try:
        inspect.signature(target).bind(**parameters)
    except TypeError as error:
        known = ", ".join(inspect.signature(target).parameters) or "none"
        raise ValueError(
            f"parameters of `{name}` must be {known}, got "
            f"{', '.join(parameters) or 'none'}: {error}."
        ) from None
    return target(**parameters)
