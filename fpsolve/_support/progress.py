"""How a run tells how far it is."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from fpsolve._support.checks import shown

__all__ = ["ProgressCallback", "reporting"]

# Called with steps done, steps in all, and the arclength reached.
ProgressCallback = Callable[[int, int, float], None]


def _silent(n_done: int, n_total: int, s: float) -> None:
    """Report nothing."""


@contextmanager
def reporting(progress: bool | ProgressCallback) -> Iterator[ProgressCallback]:
    """A callback for a run: the caller's own, a bar in the terminal, or nothing."""
    if callable(progress):
        yield progress
    elif progress is True:
        yield from _bar()
    elif progress is None or isinstance(progress, bool):
        yield _silent
    else:
        raise TypeError(
            "`progress` must be True, False or a function of (steps done, steps in "
            f"all, s), got {shown(progress)}."
        )


def _bar() -> Iterator[ProgressCallback]:
    from tqdm.auto import tqdm

    with tqdm(unit="step", file=sys.stderr) as bar:

        def report(n_done: int, n_total: int, s: float) -> None:
            bar.total = n_total
            bar.set_postfix_str(f"s = {s:g}", refresh=False)
            bar.update(n_done - bar.n)

        yield report
