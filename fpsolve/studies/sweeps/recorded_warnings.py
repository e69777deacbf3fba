"""Warnings of one case, among others that run in other threads at the same time."""

from __future__ import annotations

import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

__all__ = ["recorded_warnings"]


@contextmanager
def recorded_warnings() -> Iterator[list[warnings.WarningMessage]]:
    """Yield a list that receives the warnings of this thread, each place once.

    `warnings.catch_warnings` alone is for the process: of two threads one would get the
    warnings of the other, and the last to leave would leave its recorder behind.
    """
    caught: list[warnings.WarningMessage] = []
    before = getattr(_recorder.of_thread, "caught", None)
    _recorder.enter()
    _recorder.of_thread.caught = caught
    try:
        yield caught
    finally:
        _recorder.of_thread.caught = before
        _recorder.leave()


class _Recorder:
    """What shows warnings while anybody records them."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.n_inside = 0
        self.of_thread = threading.local()
        self.outside: Any = None
        self.show_outside: Any = None

    def enter(self) -> None:
        with self.lock:
            if self.n_inside == 0:
                self.outside = warnings.catch_warnings()
                self.outside.__enter__()
                self.show_outside = warnings.showwarning
                warnings.showwarning = self.show
            # Forgets, too, what has been shown before.
            warnings.simplefilter("default")
            self.n_inside += 1

    def leave(self) -> None:
        with self.lock:
            self.n_inside -= 1
            if self.n_inside == 0:
                self.outside.__exit__(None, None, None)

    def show(
        self, message: Any, category: Any, filename: str, lineno: int,
        file: Any = None, line: str | None = None,
    ) -> None:  # fmt: skip
        """Give a warning to the thread that it comes from."""
        caught = getattr(self.of_thread, "caught", None)
        if caught is None:
            self.show_outside(message, category, filename, lineno, file, line)
        else:
            caught.append(
                warnings.WarningMessage(message, category, filename, lineno, file, line)
            )


_recorder = _Recorder()
