"""Digests of numbers, and of what functions of unknown code return."""

from __future__ import annotations

import hashlib
import json
import re
import warnings
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array

__all__ = ["SAMPLED", "digest_of", "digest_of_answers", "plain"]


# Key, in a description, of the digest of what a user's own code computes.
SAMPLED = "sampled"
# Where an object lies in memory is not what it is.
_ADDRESS = re.compile(r" at 0x[0-9a-fA-F]+")


def digest_of(values: Array | None) -> str | None:
    """Return the SHA-256 of shape and bits; None for None."""
    if values is None:
        return None
    values = np.ascontiguousarray(values, dtype=np.float64)
    found = hashlib.sha256(str(values.shape).encode())
    found.update(values.data)
    return found.hexdigest()


def digest_of_answers(
    calls: Iterable[tuple[Callable[..., Any], tuple[Any, ...]]],
) -> str:
    """Return the SHA-256 of what functions return for their arguments, in order.

    A call that raises counts as such: far from where it is used, a user's function
    need not be defined.
    """
    found = hashlib.sha256()
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for function, arguments in calls:
            found.update(_answer(function, arguments).encode())
    return found.hexdigest()


def _answer(function: Callable[..., Any], arguments: tuple[Any, ...]) -> str:
    # A user's function raises whatever it likes.
    try:
        answer = function(*arguments)
        parts = answer if isinstance(answer, tuple | list) else (answer,)
        shape = np.broadcast_shapes(*map(np.shape, arguments))
        full = (np.broadcast_to(np.asarray(part, float), shape) for part in parts)
        return " ".join(str(digest_of(part)) for part in full)
    except Exception:
        return "refused"


def plain(value: Any) -> Any:
    """Return the value as it comes back from JSON, without addresses in memory."""
    text = json.dumps(value, default=_described, ensure_ascii=False)
    return json.loads(_ADDRESS.sub("", text))


def _described(value: Any) -> Any:
    if isinstance(value, np.generic):
        return value.item()
    return value.tolist() if isinstance(value, np.ndarray) else repr(value)
