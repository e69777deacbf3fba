"""Saved densities of a pass, appended to a zarr array while it runs.

A chunk is one density and written once: nothing that a checkpoint refers to is ever
touched again. The metadata of the array are written when it is made.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.durable import sync
from fpsolve.evolution.stored import StoredDensities

__all__ = ["PassStore"]

_DIMENSIONS = ("s", "xi1", "xi2", "alpha", "kappa")


class PassStore:
    """The array `density` in one group of a zarr store.

    Parameters
    ----------
    folder : Path
        The group, in a store that exists.
    n_saves : int
        Densities when the pass is complete.
    shape : tuple of int
        Shape of a density.

    Attributes
    ----------
    path : Path
        The array.
    n_saved : int
        Densities written so far.
    """

    def __init__(self, folder: Path, n_saves: int, shape: tuple[int, ...]) -> None:
        self.path, self.n_saves, self.shape = folder / "density", n_saves, shape
        self.n_saved = 0
        self._unsynced: list[Path] = []
        self._array: Any = None

    def save(self, p: Array) -> None:
        """Append a density."""
        if self._array is None:
            self._array = self._open() if self.n_saved else self._make()
        self._array[self.n_saved] = p
        self._unsynced.append(self._chunk(self.n_saved))
        self.n_saved += 1

    def synchronise(self) -> None:
        """Have everything on the disk that was written since the last call."""
        written, self._unsynced = self._unsynced, []
        if written:
            around = self.path, self.path / "zarr.json", self.path.parent
            for path in (*written, *around):
                sync(path)

    def densities(self) -> StoredDensities | Array:
        """The densities saved so far, left on the disk."""
        if not self.n_saved:
            return np.empty((0, *self.shape))
        return StoredDensities(self.path, (self.n_saved, *self.shape))

    def holds(self, n_saved: int) -> bool:
        """Whether so many densities are there, and have their checksums."""
        # Damage makes zarr raise whatever it comes across.
        try:
            return not n_saved or self._has(n_saved)
        except Exception:
            return False

    def _open(self) -> Any:
        import zarr

        return zarr.open_array(self.path, mode="r+")

    def _make(self) -> Any:
        import zarr
        from zarr.codecs import Crc32cCodec

        return zarr.create_array(
            self.path,
            shape=(self.n_saves, *self.shape),
            chunks=(1, *self.shape),
            dtype="float64",
            fill_value=float("nan"),
            compressors=Crc32cCodec(),
            chunk_key_encoding={"name": "v2", "separator": "."},
            dimension_names=_DIMENSIONS[: 1 + len(self.shape)],
            config={"write_empty_chunks": True},
            overwrite=True,
        )

    def _has(self, n_saved: int) -> bool:
        """Whether the first densities are as they were written."""
        array, least = self._open(), int(np.prod(self.shape)) * 8
        if array.shape != (self.n_saves, *self.shape) or array.dtype != np.float64:
            return False
        if array.chunks != (1, *self.shape):
            return False
        for number in range(n_saved):
            path = self._chunk(number)
            # One that is not there would read as NaN, one without its checksum as is.
            if not (path.is_file() and path.stat().st_size > least):
                return False
            # Reading compares the checksum.
            array[number]
        return True

    def _chunk(self, number: int) -> Path:
        return self.path / ".".join([str(number), *("0" for _ in self.shape)])
