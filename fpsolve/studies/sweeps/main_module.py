"""Keep new processes from running the user's script again, where they need not."""

from __future__ import annotations

import pickle
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from types import ModuleType
from typing import Any

__all__ = ["hidden_main", "is_needed"]

_MAIN = "__main__"


def is_needed(tasks: Iterable[Any]) -> bool:
    """Whether a process needs the user's script for one of the tasks.

    It does for functions and classes that are defined there; a pickle names their
    module.
    """
    try:
        return any(_MAIN.encode() in pickle.dumps(task) for task in tasks)
    # What cannot be pickled fails where it is sent, with an error of its own.
    except Exception:
        return True


@contextmanager
def hidden_main() -> Iterator[None]:
    """Start processes from here as if there were no script.

    A spawned process runs the module `__main__` again, for what it may define; in a
    script without the guard ``if __name__ == "__main__":`` that is everything.
    """
    script = sys.modules[_MAIN]
    sys.modules[_MAIN] = ModuleType(_MAIN)
    try:
        yield
    finally:
        sys.modules[_MAIN] = script
