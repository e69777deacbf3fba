"""One thread for BLAS, so that sums are added in the same order on every machine."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from functools import cache
from typing import Any

__all__ = ["one_blas_thread"]

# What sets a number of threads for the process (the wheels of numpy and scipy have such
# a BLAS), and what sets it for the calling thread alone.
_OF_THE_PROCESS = {
    "internal_api": ["flexiblas"],
    "threading_layer": ["pthreads", "disabled", "unknown"],
}
_OF_A_THREAD = {"internal_api": ["mkl"], "threading_layer": ["openmp"]}


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Let BLAS and LAPACK use one thread inside, whatever the environment says.

    With more of them a product is cut into as many pieces, and its last bits depend
    on their number. Ours are small, or are called from threads of numba, so that more
    threads would gain nothing either. It holds for the whole process until the last
    of the threads that are inside leaves.
    """
    limit = _limit
    limit.enter()
    try:
        own = _libraries("thread")
        with own.limit(limits=1, user_api="blas") if len(own) else nullcontext():
            yield
    finally:
        limit.leave()


class _Limit:
    """The limit of the process, and how many are inside."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.n_inside = 0
        self.limiter: Any = None

    def enter(self) -> None:
        """Set the limit, unless it is set."""
        with self.lock:
            if self.n_inside == 0:
                _take_control()
                self.limiter = _libraries("process").limit(limits=1, user_api="blas")
            self.n_inside += 1

    def leave(self) -> None:
        """Give back what was there before, if nobody else is inside."""
        with self.lock:
            self.n_inside -= 1
            if self.n_inside == 0:
                _take_control()
                self.limiter.restore_original_limits()
                _take_control()


def _take_control() -> None:
    """Let this thread set the number for the process, whichever set it last.

    Newer threadpoolctl listens to no other as long as that one lives; the last
    to leave is often not the first that came.
    """
    import threadpoolctl

    of_openblas = getattr(threadpoolctl, "OpenBLASController", None)
    release = getattr(of_openblas, "clear_controlling_thread", None)
    if release is not None:
        release(force=True)


_limit = _Limit()


def _after_fork() -> None:
    # The threads inside are not here, and the lock may have been one of theirs.
    global _limit
    _limit = _Limit()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_after_fork)


@cache
def _libraries(belonging_to: str) -> Any:
    """Libraries that use threads; finding them takes milliseconds, so it is done once.

    What is loaded later is not limited: this is the BLAS of scipy and of numba.
    """
    import scipy.linalg  # noqa: F401
    from threadpoolctl import ThreadpoolController

    chosen = _OF_THE_PROCESS if belonging_to == "process" else _OF_A_THREAD
    return ThreadpoolController().select(**chosen)
