"""Lengths that potentials are made of."""

from __future__ import annotations

from typing import Any

from fpsolve._support.checks import check_positive

__all__ = ["check_length"]

# Squares of lengths are areas, and their products with others still numbers.
_SHORTEST, _LONGEST = 1e-75, 1e75


def check_length(name: str, value: Any) -> float:
    """Return a length (or its inverse) as a float; ValueError unless of some size."""
    length = check_positive(name, value)
    if not _SHORTEST <= length <= _LONGEST:
        raise ValueError(
            f"`{name}` must lie between {_SHORTEST:g} and {_LONGEST:g}, got "
            f"{length:g}; lengths are in units of the throwing range."
        )
    return length
