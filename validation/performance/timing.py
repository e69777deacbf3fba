"""CPU time of a call: process time (all threads), median of several samples."""

from __future__ import annotations

import ctypes
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Self

# Parameters of mallopt in glibc's <malloc.h>
M_TRIM_THRESHOLD = -1
M_MMAP_THRESHOLD = -3
LARGEST_KEPT = 2**30
# A solve of a peer that takes more CPU seconds than this is made once.
ONCE_ABOVE = 5.0


def keep_memory() -> bool:
    """Ask the allocator to keep freed memory; whether it could be asked (glibc).

    By default every large temporary array can be handed back to the system and
    faulted in again page by page. That cost the Fourier code two thirds of its time
    and py-pde one third, depending on what had run before in the same process.
    """
    try:
        mallopt = ctypes.CDLL("libc.so.6").mallopt
    except (OSError, AttributeError):
        return False
    return all(
        mallopt(parameter, LARGEST_KEPT) == 1
        for parameter in (M_TRIM_THRESHOLD, M_MMAP_THRESHOLD)
    )


@dataclass
class Stopwatch:
    """Context manager: process CPU seconds (all threads) and elapsed seconds."""

    cpu: float = 0.0
    wall: float = 0.0
    _start: tuple[float, float] = field(default=(0.0, 0.0), repr=False)

    def __enter__(self) -> Self:
        """Start both clocks."""
        self._start = (time.process_time(), time.perf_counter())
        return self

    def __exit__(self, *_: object) -> None:
        """Stop both clocks."""
        self.cpu = time.process_time() - self._start[0]
        self.wall = time.perf_counter() - self._start[1]


class Measured(NamedTuple):
    """Seconds per call, medians, and what the last call returned."""

    cpu: float
    wall: float
    value: Any


def measure(
    call: Callable[[], Any],
    samples: int = 7,
    at_least: float = 0.03,
    once_above: float = float("inf"),
) -> Measured:
    """CPU and elapsed seconds per call, each the median over `samples`.

    Parameters
    ----------
    call : callable
        Called without arguments, once more than is timed.
    samples : int
    at_least : float
        A sample repeats the call until this many CPU seconds are spent, so that the
        clock's resolution and one interrupt do not matter.
    once_above : float
        A first call that takes more CPU seconds than this is the only sample.
    """
    with Stopwatch() as trial:
        value = call()
    if trial.cpu > once_above:
        return Measured(trial.cpu, trial.wall, value)
    n_calls = max(1, round(at_least / max(trial.cpu, 1e-6)))
    watches = []
    for _ in range(samples):
        with Stopwatch() as watch:
            for _ in range(n_calls):
                value = call()
        watches.append(watch)
    return Measured(
        statistics.median(watch.cpu for watch in watches) / n_calls,
        statistics.median(watch.wall for watch in watches) / n_calls,
        value,
    )
