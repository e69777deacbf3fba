"""The arrays among the arguments of a run: `p0`, and `reference` if it was given."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from fpsolve._support.digests import digest_of
from fpsolve._support.memory import allowed_memory
from fpsolve.errors import FileFormatError
from fpsolve.evolution.call import IDENTITY

__all__ = ["STORE", "digested", "read_start", "write_start"]

# The store in the folder of a checkpoint, and the group in it.
STORE, _START = "output.zarr", "start"


def digested(run: Mapping[str, Any]) -> dict[str, Any]:
    """Return the digests of the arguments that are arrays, by name."""
    return {name: one[IDENTITY] for name, one in run.items()
            if isinstance(one, dict) and IDENTITY in one}  # fmt: skip


def write_start(store: Any, arrays: Mapping[str, Any]) -> None:
    """Write arrays into the group of a zarr store."""
    group = store.create_group(_START)
    for name, values in arrays.items():
        group.create_array(
            name, data=values, chunks=values.shape, compressors=None,
            config={"write_empty_chunks": True},
        )  # fmt: skip


def read_start(folder: Path, run: Mapping[str, Any]) -> dict[str, Any]:
    """Return the arrays of a run by the names of its arguments.

    Raises
    ------
    FileFormatError
        If one is damaged, or not that of the run.
    """
    home = folder / STORE / _START
    return {name: _read(home / name, one) for name, one in digested(run).items()}


def _read(path: Path, digest: Any) -> Any:
    import zarr

    # Damage makes zarr raise whatever it comes across.
    try:
        array = zarr.open_array(path, mode="r")
        if not array.nbytes <= allowed_memory():
            raise ValueError(f"it declares {array.nbytes:.3g} bytes, more than memory")
        values = np.asarray(array[...])
    except Exception as error:
        reason = " ".join(str(error).split()).rstrip(".") or type(error).__name__
        raise FileFormatError(path, reason) from error
    if digest_of(values) != digest:
        raise FileFormatError(path, "it does not hold the start of the run")
    return values
