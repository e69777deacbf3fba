"""How much memory a run needs, and whether there is that much."""

from __future__ import annotations

import math
import time
from typing import NamedTuple

import psutil

from fpsolve._support.checks import check_tolerance
from fpsolve.errors import MemoryLimitError

__all__ = ["allowed_memory", "check_memory", "required_memory"]

# Diagnostics, tables in one dimension less, and the interpreter's own buffers.
OVERHEAD = 64 * 2**20
# To ask the system takes as long as several steps on few cells. What it said holds for
# so many seconds for who needs no more than this share of it.
SECONDS, SHARE = 1.0, 1 / 16


def required_memory(
    nbytes: int, n_arrays: float, n_saved: int, n_passes: int = 1
) -> int:
    """Bytes of a run: arrays of the scheme and saved densities, plus an overhead.

    Parameters
    ----------
    nbytes : int
        Bytes of one density.
    n_arrays : float
        Densities the scheme keeps alive.
    n_saved : int
        Densities that are saved.
    n_passes : int
        Runs that are extrapolated; each keeps its saved densities.
    """
    return int(nbytes * (n_arrays + n_saved * n_passes)) + OVERHEAD


class _Reading(NamedTuple):
    """What the system had available, and when."""

    available: float
    when: float

    def allows(self, required: int) -> bool:
        """Whether so much is there without asking again."""
        is_new = time.monotonic() - self.when <= SECONDS
        return is_new and required <= SHARE * self.available


NO_READING = _Reading(0.0, -math.inf)
_last = NO_READING


def check_memory(required: int, limit: int | None = None, *remedy: str) -> None:
    """Raise MemoryLimitError if `required` bytes are more than may be used.

    Parameters
    ----------
    required : int
    limit : int, optional
        Bytes allowed; by default what the machine has available now.
    *remedy : str
        What takes less memory, when it is not a coarser grid.
    """
    global _last
    if limit is None and _last.allows(required):
        return
    available = allowed_memory(limit)
    if limit is None:
        _last = _Reading(available, time.monotonic())
    if not required <= available:
        raise MemoryLimitError(required, int(available), *remedy)


def allowed_memory(limit: float | None = None) -> float:
    """Bytes that may be used: the limit, or what the machine has available now."""
    if limit is None:
        return float(psutil.virtual_memory().available)
    return check_tolerance("memory_limit", limit, "; it is a number of bytes")
