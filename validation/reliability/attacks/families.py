"""The families of cases, by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

__all__ = ["FAMILIES", "family"]

# Name, the function, and how many cases of it a full and a quick run draw.
FAMILIES: dict[str, tuple[Callable[..., None], int, int]] = {}


def family(full: int, quick: int = 1) -> Callable[[Any], Any]:
    """Register a function case(rng, notes) under its own name."""

    def register(case: Any) -> Any:
        FAMILIES[case.__name__] = (case, full, quick)
        return case

    return register
