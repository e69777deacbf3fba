"""JSON that comes from elsewhere: bounded in depth and in the size of its numbers."""

from __future__ import annotations

import json
from typing import Any

from fpsolve._support.checks import shown

__all__ = ["DEEPEST", "bounded_json"]

# Objects and lists in each other; what fpsolve writes has half a dozen.
DEEPEST = 40
# Numbers of more digits are no float.
_LARGEST = 10**300


def bounded_json(name: str, text: Any) -> Any:
    """Return what JSON text holds, objects and lists at most `DEEPEST` in each other.

    Parameters
    ----------
    name : str
        What messages call it.
    text : str

    Raises
    ------
    ValueError
        If it is no text, no JSON, or nested more deeply, or holds a number that is
        too large.
    """
    if not isinstance(text, str):
        raise ValueError(f"`{name}` must be JSON, got {shown(text)}.")
    try:
        value = json.loads(text)
    except RecursionError:
        raise ValueError(_too_deep(name)) from None
    except ValueError as error:
        raise ValueError(
            f"`{name}` must be JSON, got {shown(text)}: {error}."
        ) from None
    _check_bounds(name, value, DEEPEST)
    return value


def _too_deep(name: str) -> str:
    return (
        f"`{name}` must hold at most {DEEPEST} objects and lists in each other, got "
        "more."
    )


def _check_bounds(name: str, value: Any, left: int) -> None:
    if isinstance(value, dict | list):
        if not left:
            raise ValueError(_too_deep(name))
        for one in value.values() if isinstance(value, dict) else value:
            _check_bounds(name, one, left - 1)
    elif isinstance(value, int) and not -_LARGEST < value < _LARGEST:
        raise ValueError(
            f"`{name}` must hold numbers of at most 300 digits, got one of more."
        )
