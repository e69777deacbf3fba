"""Numbers as text, with their errors."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

__all__ = ["MOST_ROWS", "assigned", "evenly", "formatted", "grouped", "with_error"]

MOST_DIGITS = 10
# Rows that a table about a series has at most.
MOST_ROWS = 11


def with_error(value: float, error: float) -> str:
    """Return "0.153(16)" for 0.153 ± 0.016, two digits of the error; or what is exact.

    From one on the error is written whole: "3.2(1.6)" is 3.2 ± 1.6. Ten digits are
    shown at most, without an error if it is smaller than the last of them.
    """
    if not (math.isfinite(error) and error > 0):
        return f"{value:.4g}"
    digits = min(max(1 - math.floor(math.log10(error)), 0), MOST_DIGITS)
    if error < 10.0**-MOST_DIGITS:
        return f"{value:.{digits}f}"
    last = f"{error:.{digits}f}" if error >= 1 else f"{error * 10**digits:.0f}"
    return f"{value:.{digits}f}({last})"


def assigned(options: Mapping[str, Any], form: str = ".6g") -> str:
    """Return names with their values on a line."""
    return ", ".join(f"{name} = {_value(one, form)}" for name, one in options.items())


def _value(value: Any, form: str) -> str:
    if isinstance(value, Mapping):
        return f"({assigned(value, form)})"
    if isinstance(value, (list, tuple)):
        return f"({', '.join(_value(one, form) for one in value)})"
    return format(value, form) if isinstance(value, float) else str(value)


def grouped(count: int) -> str:
    """Return "1 000 000": thousands apart."""
    return f"{count:,}".replace(",", " ")


def formatted(values: Iterable[float], form: str) -> list[str]:
    """Return every number in that format."""
    return [format(float(value), form) for value in values]


def evenly(count: int) -> list[int]:
    """Return at most `MOST_ROWS` places from first to last of so many."""
    places = np.linspace(0, count - 1, min(count, MOST_ROWS))
    return [int(place) for place in places.round()]
