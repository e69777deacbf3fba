"""Whether what a file declares to hold fits into memory, before it is read."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

from fpsolve._support.memory import allowed_memory
from fpsolve.errors import FileFormatError

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["check_bytes", "check_sizes"]

# Bytes of a text in memory, where a file has only references.
_TEXT = 64
# What libraries call the pieces in which a variable is compressed.
_PIECES = ("chunksizes", "chunks", "shards")


def check_sizes(path: Path, dataset: xr.Dataset) -> None:
    """Raise FileFormatError if the variables of a dataset do not fit into memory.

    A few kilobytes of a compressed file may declare terabytes.

    Parameters
    ----------
    path : Path
        The file.
    dataset : xarray.Dataset
        Opened, not read.
    """
    sizes = {str(name): _bytes_of(one) for name, one in dataset.variables.items()}
    largest = max(sizes, key=lambda name: sizes[name], default="")
    check_bytes(path, sum(sizes.values()), f"of it `{largest}` the most")


def check_bytes(path: Path, n_bytes: int, remark: str) -> None:
    """Raise FileFormatError unless so many bytes may be read into memory."""
    available = allowed_memory()
    if not n_bytes <= available:
        needed, free = n_bytes / 2**30, available / 2**30
        raise FileFormatError(
            path,
            f"it declares {needed:.3g} GiB, {remark}, and {free:.3g} GiB of memory are "
            "available; read it on a larger machine, or make it again",
        )


def _bytes_of(variable: xr.Variable) -> int:
    """Return the bytes of a variable, or of one of its pieces if that is more."""
    item = _TEXT if variable.dtype.kind in ("O", "T") else variable.dtype.itemsize
    pieces = [variable.encoding.get(name) or () for name in _PIECES]
    return item * max(math.prod(map(int, one)) for one in (variable.shape, *pieces))
