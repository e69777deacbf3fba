"""Threads of the kernels: no more than a density has work for, none after a fork."""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import Any

from fpsolve.errors import ForkedProcessError

__all__ = [
    "CELLS_PER_THREAD",
    "check_not_forked",
    "parallel_region",
    "threads_worth_their_wait",
]

# A step on so many cells takes a millisecond or two. With less to do, threads wait for
# one another as long as they compute; on a machine that is busy with other work, ten
# times as long.
CELLS_PER_THREAD = 2**17


@contextmanager
def threads_worth_their_wait(n_cells: int) -> Iterator[None]:
    """Let kernels use at most one thread for every 2¹⁷ cells inside.

    Fewer where numba was told so. Results do not depend on it, and neither does what
    other threads of Python may use: numba keeps this number for each of them.

    Raises
    ------
    ForkedProcessError
        Where kernels cannot run.
    """
    import numba

    check_not_forked()
    before = numba.get_num_threads()
    numba.set_num_threads(max(1, min(before, n_cells // CELLS_PER_THREAD)))
    try:
        yield
    finally:
        numba.set_num_threads(before)


def parallel_region() -> AbstractContextManager[object]:
    """The context in which a kernel may use threads.

    With numba's own layer "workqueue" only one thread of Python can be in it at a
    time: a second one would end the process.

    Raises
    ------
    ForkedProcessError
        Where kernels cannot run.
    """
    check_not_forked()
    return _region.context or _region.entered()


def check_not_forked() -> None:
    """Raise ForkedProcessError in a process that was forked from running threads."""
    if _region.lost:
        raise ForkedProcessError


class _Region:
    """What is known of the threads of this process.

    Attributes
    ----------
    lost : bool
        Whether numba believes in threads that a fork has left behind.
    context : context manager or None
        What kernels run in, once numba has chosen its layer.
    """

    def __init__(self, lost: bool = False) -> None:
        self.lost = lost
        self.context: AbstractContextManager[object] | None = None
        self.lock = threading.RLock()

    def entered(self) -> AbstractContextManager[object]:
        """Find out the context; numba chooses its layer at the latest now."""
        import numba

        numba.get_num_threads()
        one_at_a_time = _layer() == "workqueue"
        self.context = self.lock if one_at_a_time else nullcontext()
        return self.context


_region = _Region()


def _after_fork() -> None:
    # A lock may be held by a thread that is not here any more.
    global _region
    _region = _Region(_region.lost or _threads_do_not_survive())


def _threads_do_not_survive() -> bool:
    """Whether threads have been started that a forked process waits for in vain.

    GNU OpenMP does not know that they are gone. Numba ends a child that uses it, after
    which a pool starts the next, and does not notice a grandchild, which then waits
    for ever. Its other layers start anew.
    """
    return _layer() == "omp" and sys.platform.startswith("linux")


def _layer() -> str:
    """What numba has its threads from; nothing as long as it has none."""
    numba: Any = sys.modules.get("numba")
    try:
        return "" if numba is None else str(numba.threading_layer())
    except ValueError:
        return ""


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_after_fork)
