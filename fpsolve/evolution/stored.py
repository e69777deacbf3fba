"""Saved densities that stay on the disk until they are asked for."""

from __future__ import annotations

import operator
from collections.abc import Iterator, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from fpsolve._kernels.combining import add_weighted
from fpsolve._support.arrays import Array
from fpsolve.errors import FileFormatError

__all__ = [
    "CombinedDensities",
    "LazyDensities",
    "StoredDensities",
    "WeightedDensities",
    "weighted",
]


def weighted(densities: Sequence[Array], weights: Array) -> Array:
    """Σ_j w_mj p_j for every row of weights; shape (m, *shape of a density)."""
    sums = np.empty((weights.shape[0], *densities[0].shape))
    flat = sums.reshape(len(sums), -1)
    for number, p in enumerate(densities):
        row = np.ascontiguousarray(weights[:, number])
        add_weighted(np.ascontiguousarray(p).reshape(-1), row, flat, number == 0)
    return sums


class LazyDensities(NDArrayOperatorsMixin):
    """An array of shape (n_saved, n1, n2, n_alpha), read one density at a time.

    Indexing gives ndarrays and reads only the densities that the first index picks.
    `numpy.asarray` reads them all, and so does arithmetic with the whole.
    """

    shape: tuple[int, ...]
    dtype = np.dtype(np.float64)

    def read(self, index: int) -> Array:
        """One density; shape (n1, n2, n_alpha)."""
        raise NotImplementedError

    @property
    def ndim(self) -> int:
        """Number of dimensions, 4."""
        return len(self.shape)

    @property
    def size(self) -> int:
        """Number of values."""
        return int(np.prod(self.shape))

    @property
    def nbytes(self) -> int:
        """Bytes on the disk, and in memory once all are read."""
        return self.size * self.dtype.itemsize

    def __len__(self) -> int:
        return self.shape[0]

    def __iter__(self) -> Iterator[Array]:
        return (self.read(index) for index in range(len(self)))

    def __getitem__(self, key: Any) -> Any:
        first, *others = key if isinstance(key, tuple) else (key,)
        if first is None or first is Ellipsis:
            return np.asarray(self)[key]
        rest = tuple(others)
        try:
            index = operator.index(first)
        except TypeError:
            chosen = np.arange(len(self))[first].tolist()
            empty = np.empty((0, *self.shape[1:]))[(slice(None), *rest)]
            return np.array([self.read(k)[rest] for k in chosen]) if chosen else empty
        return self.read(range(len(self))[index])[rest]

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Array:
        if copy is False:
            raise ValueError("`copy` must not be False: the densities are on the disk.")
        values = np.empty(self.shape)
        for index in range(len(self)):
            values[index] = self.read(index)
        return values if dtype is None else values.astype(dtype)

    def __array_ufunc__(
        self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any
    ) -> Any:
        read = (np.asarray(x) if isinstance(x, LazyDensities) else x for x in inputs)
        return getattr(ufunc, method)(*read, **options)

    def __repr__(self) -> str:
        return f"{type(self).__name__}(shape={self.shape})"


class StoredDensities(LazyDensities):
    """The first densities of a zarr array.

    Parameters
    ----------
    path : Path
        Folder of the array.
    shape : (int, int, int, int)
        Shape of what belongs to the result; the array may hold more.
    """

    def __init__(self, path: Path, shape: tuple[int, ...]) -> None:
        self.path, self.shape = path, shape

    @cached_property
    def _array(self) -> Any:
        import zarr

        return zarr.open_array(self.path, mode="r")

    def read(self, index: int) -> Array:
        """One density; its checksum is tested."""
        # Damage makes zarr raise whatever it comes across.
        try:
            found: Array = np.asarray(self._array[index])
        except Exception as error:
            reason = str(error).rstrip(".") or type(error).__name__
            raise FileFormatError(self.path, f"density {index}: {reason}") from error
        if found.shape != self.shape[1:] or found.dtype != self.dtype:
            reason = f"its shape is {found.shape}, not {self.shape[1:]}"
            raise FileFormatError(self.path, f"density {index}: {reason}")
        return found

    def __getstate__(self) -> dict[str, Any]:
        return {"path": self.path, "shape": self.shape}


class WeightedDensities(LazyDensities):
    """Σ_j w_j p_j for the densities p_j of several runs.

    Parameters
    ----------
    runs : sequence of LazyDensities or ndarray
    weights : sequence of float
    """

    def __init__(self, runs: Sequence[Any], weights: Sequence[float]) -> None:
        self.runs, self.weights = tuple(runs), tuple(weights)
        self.shape = runs[0].shape

    def read(self, index: int) -> Array:
        """One density, summed from the first run to the last."""
        runs = [run[index] for run in self.runs]
        combined: Array = weighted(runs, np.array([self.weights]))[0]
        return combined


class CombinedDensities(LazyDensities):
    """(1 + g) p − g q for the densities p of one run and q of another.

    Parameters
    ----------
    fine, coarse : LazyDensities
        p and q.
    gain : float
        g.
    """

    def __init__(self, fine: LazyDensities, coarse: LazyDensities, gain: float) -> None:
        self.fine, self.coarse, self.gain = fine, coarse, gain
        self.shape = fine.shape

    def read(self, index: int) -> Array:
        """One density, rounded as if all were combined in memory."""
        p, q = self.fine.read(index), self.coarse.read(index)
        p *= 1.0 + self.gain
        q *= self.gain
        p -= q
        return p
