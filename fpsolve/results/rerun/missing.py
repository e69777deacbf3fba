"""What is said when a result cannot be repeated."""

from __future__ import annotations

from fpsolve.errors import NotRepeatableError

__all__ = ["own_code", "unrecorded"]

_LONGEST = 120


def own_code(argument: str, description: str) -> NotRepeatableError:
    """Return the error for an argument that was a user's own code."""
    text = description if len(description) <= _LONGEST else f"{description[:118]} …"
    known = f" ({text})" if text else ""
    return NotRepeatableError(
        f"`{argument}` was your own code{known}, which no file holds; pass it as "
        f"`fpsolve.rerun(file, {argument}=...)`."
    )


def unrecorded(what: str, function: str) -> NotRepeatableError:
    """Return the error for a result that does not say enough."""
    return NotRepeatableError(
        f"the result does not say {what}; it was put together by hand. "
        f"Call {function} again and save the result."
    )
