"""The families of cases, by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

__all__ = ["FAMILIES", "family"]

# Name, the function, how many cases a full run draws, and which of them a quick one.
FAMILIES: dict[str, tuple[Callable[..., None], int, tuple[int, ...]]] = {}


def family(full: int, quick: int | tuple[int, ...] = 1) -> Callable[[Any], Any]:
    """Register a function case(rng, notes) under its own name.

    A quick run makes the first cases, so many, or those that are named: cheap ones.
    """

    def register(case: Any) -> Any:
        chosen = tuple(range(quick)) if isinstance(quick, int) else quick
        FAMILIES[case.__name__] = (case, full, chosen)
        return case

    return register
