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
    folders = sorted(_cache_folders())
    files = [
        file
        for folder in folders
        for pattern in ("*.nbi", "*.nbc")
        for file in folder.glob(pattern)
    ]
    size = sum(file.stat().st_size for file in files)
    if not folders:
        return "none; set NUMBA_CACHE_DIR to a folder that can be written"
    places = ", ".join(map(str, folders))
    return f"{places} ({len(files)} files, {size / 2**20:.1f} MiB)"


def _cache_folders() -> set[Path]:
    paths = (kernel.stats.cache_path for kernel in _kernels())
    return {Path(path) for path in paths if path is not None}


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
