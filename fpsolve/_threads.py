"""Threads of the kernels: no more than a density has work for."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["CELLS_PER_THREAD", "threads_worth_their_wait"]

# A step on so many cells takes a millisecond or two. With less to do, threads wait for
# one another as long as they compute; on a machine that is busy with other work, ten
# times as long.
CELLS_PER_THREAD = 2**17


@contextmanager
def threads_worth_their_wait(n_cells: int) -> Iterator[None]:
    """Let kernels use at most one thread for every 2¹⁷ cells inside.

    Fewer where numba was told so. Results do not depend on it.
    """
    import numba

    before = numba.get_num_threads()
    numba.set_num_threads(max(1, min(before, n_cells // CELLS_PER_THREAD)))
    try:
        yield
    finally:
        numba.set_num_threads(before)
