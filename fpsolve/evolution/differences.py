"""What differs between two descriptions, leaf by leaf."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

__all__ = ["differences"]


def _any(table: Mapping[str, Any]) -> Any:
    return None


def differences(
    old: Any, new: Any, name: str = "", sort: Callable[[Mapping[str, Any]], Any] = _any
) -> Iterator[tuple[str, Any, Any]]:
    """Yield name, old and new value of everything in which two tables differ.

    Parameters
    ----------
    old, new : mapping, or what one holds; None for what is not there
    name : str
        Of both; that of an entry of a table begins with that of the table.
    sort : callable
        Of a table; two tables of different sorts are not compared entry by entry.
    """
    values = [one for one in (old, new) if one is not None]
    if values and all(isinstance(one, Mapping) for one in values):
        before, after = old or {}, new or {}
        if sort(before) == sort(after):
            for key in {**before, **after}:
                path = f"{name}.{key}" if name else str(key)
                yield from differences(before.get(key), after.get(key), path, sort)
            return
    if old != new:
        yield name, old, new
