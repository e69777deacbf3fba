"""Records and saved densities of a pass, appended to zarr arrays while it runs.

A chunk is written once, when it is full: nothing that a checkpoint refers to is ever
touched again. The metadata of an array are written when it is made.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.durable import sync
from fpsolve.density.snapshot import rows_to_array
from fpsolve.evolution.stored import StoredDensities

__all__ = ["ROWS", "PassStore"]

Array = NDArray[np.float64]
Row = dict[str, float]

# Records in a chunk.
ROWS = 256
_DIMENSIONS = {"density": ("s", "xi1", "xi2", "alpha"), "series": ("step", "quantity")}


class PassStore:
    """The arrays `density` and `series` in one group of a zarr store.

    Parameters
    ----------
    folder : Path
        The group, in a store that exists.
    n_records, n_saves : int
        Records and densities when the pass is complete.
    shape : (int, int, int)
        Shape of a density.

    Attributes
    ----------
    n_saved, n_stored : int
        Densities and rows written so far.
    """

    def __init__(
        self, folder: Path, n_records: int, n_saves: int, shape: tuple[int, ...]
    ) -> None:
        self.folder = folder
        self.n_records, self.n_saves, self.shape = n_records, n_saves, shape
        self.n_saved = self.n_stored = 0
        self._unsynced: list[Path] = []
        self._arrays: dict[str, Any] = {}

    def continue_from(self, n_saved: int, n_stored: int) -> None:
        """Forget what was written after so many densities and rows."""
        self.n_saved, self.n_stored = n_saved, n_stored

    def save(self, p: Array) -> None:
        """Append a density."""
        size = (self.n_saves, *self.shape)
        array = self._array("density", self.n_saved, size, 1)
        array[self.n_saved] = p
        self._note(array, self.n_saved)
        self.n_saved += 1

    def absorb(self, rows: list[Row], complete: bool = False) -> None:
        """Take full chunks of rows, all of them when the pass is complete."""
        while len(rows) >= ROWS or (rows and complete):
            self._append(rows[:ROWS])
            del rows[:ROWS]

    def synchronise(self) -> None:
        """Have everything on the disk that was written since the last call."""
        written, self._unsynced = self._unsynced, []
        for path in dict.fromkeys(written):
            sync(path)

    def series(self, columns: tuple[str, ...], rows: list[Row]) -> dict[str, Array]:
        """All rows, those on the disk first, as arrays of shape (n,)."""
        tail = rows_to_array(rows, columns)
        values = tail
        if self.n_stored:
            stored = self._array("series", self.n_stored, (), 0)[: self.n_stored]
            values = np.concatenate([np.asarray(stored), tail])
        return {name: values[:, k].copy() for k, name in enumerate(columns)}

    def densities(self) -> StoredDensities | Array:
        """The densities saved so far, left on the disk."""
        if not self.n_saved:
            return np.empty((0, *self.shape))
        return StoredDensities(self.folder / "density", (self.n_saved, *self.shape))

    def holds(self, n_saved: int, n_stored: int) -> bool:
        """Whether so many densities and rows are there, and have their checksums."""
        # Damage makes zarr raise whatever it comes across.
        try:
            return self._has("density", n_saved, 1) and self._has(
                "series", n_stored, min(ROWS, self.n_records)
            )
        except Exception:
            return False

    def _append(self, rows: list[Row]) -> None:
        columns = tuple(rows[0])
        size = (self.n_records, len(columns))
        array = self._array("series", self.n_stored, size, ROWS, quantities=columns)
        array[self.n_stored : self.n_stored + len(rows)] = rows_to_array(rows, columns)
        self._note(array, self.n_stored // ROWS)
        self.n_stored += len(rows)

    def _array(
        self, name: str, begun: int, size: tuple[int, ...], chunk: int, **about: Any
    ) -> Any:
        if name not in self._arrays:
            if begun:
                self._arrays[name] = self._open(name)
            else:
                self._arrays[name] = self._make(name, size, chunk, about)
        return self._arrays[name]

    def _open(self, name: str) -> Any:
        import zarr

        return zarr.open_array(self.folder / name, mode="r+")

    def _make(
        self, name: str, size: tuple[int, ...], chunk: int, about: dict[str, Any]
    ) -> Any:
        import zarr
        from zarr.codecs import Crc32cCodec

        return zarr.create_array(
            self.folder / name,
            shape=size,
            chunks=(min(chunk, size[0]), *size[1:]),
            dtype="float64",
            fill_value=float("nan"),
            compressors=Crc32cCodec(),
            chunk_key_encoding={"name": "v2", "separator": "."},
            dimension_names=_DIMENSIONS[name],
            attributes=about,
            config={"write_empty_chunks": True},
            overwrite=True,
        )

    def _note(self, array: Any, chunk: int) -> None:
        folder = self.folder / array.path if array.path else Path(array.store.root)
        self._unsynced += [folder / self._key(array.ndim, chunk), folder]
        self._unsynced += [folder / "zarr.json", folder.parent]

    def _has(self, name: str, n: int, chunk: int) -> bool:
        """Whether the first n entries of an array are as they were written."""
        if not n:
            return True
        array = self._open(name)
        size = (self.n_saves, *self.shape) if name == "density" else (self.n_records,)
        if array.shape[: len(size)] != size or array.dtype != np.float64:
            return False
        if array.chunks != (chunk, *array.shape[1:]):
            return False
        least = int(np.prod(array.chunks)) * array.dtype.itemsize
        for first in range(0, n, chunk):
            path = self.folder / name / self._key(array.ndim, first // chunk)
            # One that is not there would read as NaN, one without its checksum as is.
            if not (path.is_file() and path.stat().st_size > least):
                return False
            # Reading compares the checksum.
            array[first : min(first + chunk, n)]
        return True

    @staticmethod
    def _key(ndim: int, chunk: int) -> str:
        return ".".join([str(chunk), *["0"] * (ndim - 1)])
