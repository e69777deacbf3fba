"""Word of compilation: the first use of a kernel on a machine takes seconds."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from numba.core import event

__all__ = ["announce"]


class _FirstCompilation(event.Listener):
    """Call back once, with the name of the first function that is compiled."""

    def __init__(self, callback: Callable[[str], None]) -> None:
        self.callback = callback
        self.announced = False

    def on_start(self, event: Any) -> None:
        if not self.announced:
            self.announced = True
            self.callback(event.data["dispatcher"].py_func.__name__)

    def on_end(self, event: Any) -> None:
        """Nothing: the first start is all that is told."""


@contextmanager
def announce(callback: Callable[[str], None]) -> Iterator[None]:
    """Call `callback(name)` if numba compiles anything; loading a cache is silent."""
    listener = _FirstCompilation(callback)
    with event.install_listener("numba:compile", listener):
        yield
