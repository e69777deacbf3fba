"""`fpsolve info`: versions, threads and the compile cache."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from fpsolve.cli.console import print_lines
from fpsolve.cli.frame import command

__all__ = ["info"]


def info() -> None:
    """Print versions, threads and compile cache."""
    with command():
        from fpsolve._support.provenance import versions

        rows = {**versions(), "threads": _threads(), "compile cache": _cache()}
        width = max(map(len, rows))
        # No table: paths are for copying, so they are neither wrapped nor cut.
        lines = (f"{name:{width}}  {text}" for name, text in rows.items())
        print_lines(*lines, whole=True)


def _threads() -> str:
    import numba

    settings: Any = numba.config
    return (
        f"{numba.get_num_threads()} of {settings.NUMBA_NUM_THREADS}, threading layer "
        f"{settings.THREADING_LAYER}"
    )


def _cache() -> str:
    found = {kernel.stats.cache_path for kernel in _kernels()} - {None}
    folders = sorted(map(Path, found))
    if not folders:
        return "none; set NUMBA_CACHE_DIR to a folder that can be written"
    files = [file for folder in folders for file in folder.glob("*.nb[ic]")]
    size = sum(file.stat().st_size for file in files)
    places = ", ".join(map(str, folders))
    return f"{places} ({len(files)} files, {size / 2**20:.1f} MiB)"


def _kernels() -> Iterator[Any]:
    """Yield every compiled function of the package."""
    import importlib
    import pkgutil

    from numba.core.dispatcher import Dispatcher

    package = importlib.import_module("fpsolve._kernels")
    for module in pkgutil.iter_modules(package.__path__, f"{package.__name__}."):
        for value in vars(importlib.import_module(module.name)).values():
            compiled = getattr(value, "compiled", value)
            if isinstance(compiled, Dispatcher):
                yield compiled
