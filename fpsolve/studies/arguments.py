"""Checks of what studies are asked: noises, parts and functions to average."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from fpsolve._support.checks import check_call, shown

__all__ = ["check_functions", "names_of", "series_of"]


def series_of(noises: Any, name: str = "noises") -> list[Any]:
    """Return a series as a list; TypeError unless it is one."""
    if isinstance(noises, str | bytes) or not isinstance(noises, Iterable):
        raise TypeError(
            f"`{name}` must be a series of numbers, got {shown(noises)}; a single one "
            "needs brackets too."
        )
    return list(noises)


def names_of(parts: Any, name: str = "parts") -> list[str]:
    """Return a series of names as a list; TypeError unless it is one."""
    if isinstance(parts, str | bytes) or not isinstance(parts, Iterable):
        raise TypeError(
            f"`{name}` must be a series of names, got {shown(parts)}; a single one "
            "needs brackets too."
        )
    return list(parts)


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
