"""Checks of what studies are asked: noises, parts and functions to average."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from fpsolve._support.checks import (
    check_call,
    check_integer,
    check_noise,
    check_positive,
    has_length,
    shown,
)

__all__ = [
    "check_functions",
    "checked_pair",
    "chosen_parts",
    "noises_of",
    "series_of",
    "several",
]


def series_of(values: Any, name: str = "noises", what: str = "numbers") -> list[Any]:
    """Return a series as a list; TypeError unless it is one."""
    if isinstance(values, str | bytes) or not isinstance(values, Iterable):
        raise TypeError(
            f"`{name}` must be a series of {what}, got {shown(values)}; a single one "
            "needs brackets too."
        )
    return list(values)


def noises_of(noises: Any, remedy: str = "") -> list[float]:
    """Return the noises as floats; an error unless there are some, all positive."""
    listed = [check_noise("noises", noise, remedy) for noise in series_of(noises)]
    if not listed:
        raise ValueError("`noises` must hold at least one noise, got none.")
    return listed


def chosen_parts(parts: Any, possible: Sequence[str], whose: str) -> list[str]:
    """Return the parts asked for, all if None, in the order in which they are possible.

    Parameters
    ----------
    parts : iterable of str, or None
    possible : sequence of str
    whose : str
        What makes others impossible, for the message.
    """
    chosen = possible if parts is None else series_of(parts, "parts", "names")
    unknown = [part for part in chosen if part not in possible]
    if unknown or not chosen:
        raise ValueError(
            f"`parts` must be among {', '.join(possible)} for this {whose}, got "
            f"{', '.join(map(str, unknown)) or 'none'}."
        )
    return [part for part in possible if part in chosen]


def check_functions(functions: Any) -> dict[str, Callable[..., Any]]:
    """Return the functions by name; an error unless there are some, to be called."""
    if not isinstance(functions, Mapping):
        raise TypeError(
            "`functions` must be a mapping of names to f(xi1, xi2, alpha), got "
            f"{shown(functions)}."
        )
    if not functions:
        raise ValueError("`functions` must hold at least one function, got none.")
    for name, function in functions.items():
        check_call(f"functions[{name!r}]", function, "f(xi1, xi2, alpha)")
    return {str(name): function for name, function in functions.items()}


def checked_pair(name: str, pair: Any) -> tuple[float, float]:
    """Lowest and highest value; ValueError unless 0 < lowest < highest."""
    called = f"bounds[{name!r}]"
    if not has_length(pair, 2):
        raise ValueError(f"`{called}` must be (lowest, highest), got {shown(pair)}.")
    low, high = (check_positive(called, end) for end in pair)
    if not low < high:
        raise ValueError(
            f"`{called}` must be (lowest, highest), got ({low:g}, {high:g})."
        )
    return low, high


def several(name: str, value: Any) -> int:
    """The number; ValueError below 0, and for one alone, which has no spread."""
    number = check_integer(name, value, at_least=0)
    if number == 1:
        raise ValueError(f"`{name}` must be 0 or at least 2, got 1; one has no spread.")
    return number
