"""What a user sees when something goes wrong: one line and an exit code."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, NoReturn

import typer

__all__ = ["BAD_INPUT", "FAILED", "INTERRUPTED", "fail", "reported_errors", "say"]

FAILED, BAD_INPUT, INTERRUPTED = 1, 2, 130
_NO_MEMORY = (
    "memory must suffice, got none any more; choose a coarser grid, fewer paths or "
    "fewer saved densities."
)


@contextmanager
def reported_errors() -> Iterator[None]:
    """Print errors and warnings as one line each, and exit with the right code.

    A wrong argument, configuration or file gives 2, a computation that cannot go on
    or a file that cannot be written 1, Ctrl-C 130. What is none of these is a defect
    of fpsolve, and keeps its traceback.
    """
    from fpsolve.errors import ConfigurationError, FileFormatError, FpsolveError

    bad_input = (
        ConfigurationError,
        FileFormatError,
        FileNotFoundError,
        IsADirectoryError,
        NotADirectoryError,
        ImportError,
        ValueError,
        TypeError,
    )
    with warnings.catch_warnings():
        warnings.simplefilter("default", UserWarning)
        warnings.showwarning = _teller()
        try:
            yield
        except bad_input as error:
            fail(error, BAD_INPUT)
        except (FpsolveError, OSError) as error:
            fail(error, FAILED)
        except MemoryError:
            fail(_NO_MEMORY, FAILED)
        except KeyboardInterrupt:
            fail("interrupted", INTERRUPTED)


def fail(error: object, code: int) -> NoReturn:
    """Print "error: ..." and exit."""
    say(f"error: {error}")
    raise typer.Exit(code)


def say(text: str) -> None:
    """Print a line to the standard error stream."""
    print(text, file=sys.stderr)


def _teller() -> Callable[..., None]:
    """Return what prints a warning, the first time that it comes."""
    told: set[str] = set()

    def tell(message: Warning | str, *_: Any, **__: Any) -> None:
        if str(message) not in told:
            told.add(str(message))
            say(f"warning: {message}")

    return tell
