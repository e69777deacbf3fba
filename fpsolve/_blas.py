"""One thread for BLAS, so that sums are added in the same order on every machine."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

__all__ = ["one_blas_thread"]


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Let BLAS and LAPACK use one thread inside, whatever the environment says.

    With more of them a product is cut into as many pieces, and its last bits depend
    on their number. Ours are small, or are called from threads of numba, so that more
    threads would gain nothing either. It holds for the whole process until the end.
    """
    with _libraries().limit(limits=1, user_api="blas"):
        yield


@cache
def _libraries() -> Any:
    """Libraries that use threads; finding them takes milliseconds, so it is done once.

    What is loaded later is not limited: this is the BLAS of scipy and of numba.
    """
    import scipy.linalg  # noqa: F401
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()
