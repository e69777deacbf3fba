"""The command `fpsolve`, which also writes every step it reports to a pipe.

Usage: reporting_child.py DESCRIPTOR run …; `kill_and_resume.py` starts it.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from fpsolve.cli import main, progress


@contextmanager
def telling_bar() -> Iterator[Callable[[int, int, float], None]]:
    """In the place of the progress bar."""

    def report(n_done: int, n_total: int, s: float) -> None:
        os.write(DESCRIPTOR, f"{n_done}\n".encode())

    yield report


if __name__ == "__main__":
    DESCRIPTOR = int(sys.argv.pop(1))
    progress.progress_bar = telling_bar
    main()
