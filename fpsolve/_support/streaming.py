"""Variables that are written block after block, because they do not fit into memory."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fpsolve._support.checksums import CHECKSUMS, digest_of, with_digest

__all__ = ["Streamed", "append"]


class Streamed(NamedTuple):
    """A variable whose blocks, along its first dimension, come one by one.

    Attributes
    ----------
    name : str
    dimensions : tuple of str
    shape : tuple of int
    dtype : dtype
    blocks : iterable of ndarray
        Can be gone through more than once.
    attributes : dict
    chunks : tuple of int
        Of a zarr store; by default as the blocks.
    parts : iterable of (index, ndarray), optional
        The same numbers in the order of the chunks; by default the blocks.
    """

    name: str
    dimensions: tuple[str, ...]
    shape: tuple[int, ...]
    dtype: np.dtype[Any]
    blocks: Iterable[Any]
    attributes: dict[str, str]
    chunks: tuple[int, ...] = ()
    parts: Iterable[tuple[Any, Any]] | None = None

    @property
    def nbytes(self) -> int:
        """Bytes of the whole variable."""
        return int(np.prod(self.shape)) * self.dtype.itemsize


def append(draft: Path, engine: str, variable: Streamed) -> None:
    """Add the variable to a file that holds the rest of the dataset."""
    if engine == "zarr":
        _append_to_zarr(draft, variable)
    else:
        _append_to_netcdf(draft, variable)


def _append_to_netcdf(draft: Path, variable: Streamed) -> None:
    import h5netcdf

    with h5netcdf.File(draft, "a") as file:
        array = file.create_variable(variable.name, variable.dimensions, variable.dtype)
        array.attrs.update(variable.attributes)
        for index, block in enumerate(variable.blocks):
            array[index] = block
        file.attrs[CHECKSUMS] = _complete(file.attrs[CHECKSUMS], variable)


def _append_to_zarr(draft: Path, variable: Streamed) -> None:
    import zarr

    group = zarr.open_group(draft, mode="r+")
    array = group.create_array(
        variable.name,
        shape=variable.shape,
        chunks=variable.chunks or (1, *variable.shape[1:]),
        dtype=variable.dtype,
        fill_value=float("nan"),
        dimension_names=variable.dimensions,
        attributes=dict(variable.attributes),
    )
    parts = variable.parts
    for index, block in enumerate(variable.blocks) if parts is None else parts:
        array[index] = block
    group.attrs[CHECKSUMS] = _complete(str(group.attrs[CHECKSUMS]), variable)


def _complete(checksums: str, variable: Streamed) -> str:
    """Return the checksums with that of the variable."""
    name, dimensions, shape, dtype, blocks, attributes, *_ = variable
    digest = digest_of(name, dimensions, shape, dtype, attributes, blocks)
    return with_digest(checksums, name, digest)
