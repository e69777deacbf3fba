"""What made a result: versions, environment, date, times; word of compilation."""

from __future__ import annotations

import logging
import platform
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from fpsolve._support.compilation import announce
from fpsolve._support.environment import environment

__all__ = ["Stopwatch", "announced_compilation", "versions"]

LOGGER = logging.getLogger("fpsolve")
PACKAGES = ("fpsolve", "numpy", "scipy", "numba", "xarray")


@cache
def known_versions() -> tuple[tuple[str, str], ...]:
    """Name and version of Python, of fpsolve and of what it computes with."""
    found = {"python": platform.python_version()}
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "not installed"
    return tuple(found.items())


def versions() -> dict[str, str]:
    """Versions of Python, of fpsolve and of what it computes with."""
    return dict(known_versions())


class Stopwatch:
    """Wall and CPU time since it was made, and before."""

    def __init__(self) -> None:
        self.wall, self.cpu = time.perf_counter(), time.process_time()

    def add(self, wall: float, cpu: float) -> None:
        """Count seconds that were spent before."""
        self.wall -= wall
        self.cpu -= cpu

    def seconds(self) -> tuple[float, float]:
        """Wall and CPU time."""
        return time.perf_counter() - self.wall, time.process_time() - self.cpu

    def provenance(
        self, n_steps: int | None = None, known: dict[str, Any] | None = None
    ) -> dict[str, Any]:
        """Versions, environment, date, seconds, number of steps, ready for a file.

        With the environment that is `known`, where it has been looked up.
        """
        wall, cpu = self.seconds()
        steps = {} if n_steps is None else {"n_steps": n_steps}
        return {
            "versions": versions(),
            "environment": environment() if known is None else known,
            "date": datetime.now(UTC).isoformat(timespec="seconds"),
            "wall_seconds": wall,
            "cpu_seconds": cpu,
            **steps,
        }


@contextmanager
def announced_compilation(aloud: bool) -> Iterator[None]:
    """Log that kernels compile, and say so on the terminal if `aloud`."""
    from fpsolve._kernels.compiling import kernels_are_kept

    def tell(name: str) -> None:
        LOGGER.info("compiling kernels, beginning with %s", name)
        if aloud:
            kept = "once, then cached" if kernels_are_kept() else "not to be kept"
            print(f"compiling kernels ({kept}) …", file=sys.stderr)

    with announce(tell):
        yield
