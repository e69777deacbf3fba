"""The nearest valid name to a misspelt one."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import SequenceMatcher

__all__ = ["suggestion"]

# Share of matching letters from which a name counts as meant.
_NEAR = 0.5


def suggestion(name: str, known: Iterable[str], quote: str = "`{}`") -> str:
    """Return the end of a sentence: "; did you mean `noise`?", or "." if none is near.

    Parameters
    ----------
    name : str
        What was written.
    known : iterable of str
        What could have been meant; the first of equally near ones is named.
    quote : str
        How to quote a name.
    """

    def nearness(candidate: str) -> float:
        return SequenceMatcher(None, name, candidate).ratio()

    nearest = max(known, key=nearness, default="")
    near = nearest and nearness(nearest) >= _NEAR
    return f"; did you mean {quote.format(nearest)}?" if near else "."
