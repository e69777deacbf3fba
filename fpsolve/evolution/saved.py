"""What every result shares that can be saved."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from fpsolve._support.labels import marked
from fpsolve._support.netcdf import write_dataset

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Saved", "described_as"]


class Saved:
    """A result that a labelled Dataset holds whole."""

    def to_xarray(self) -> xr.Dataset:
        """Return the result as a labelled Dataset, from which `load` makes it again."""
        raise NotImplementedError

    def save(self, path: str | Path, engine: str | None = None) -> Path:
        """Write the result to netCDF, or to zarr for a path that ends in .zarr."""
        return write_dataset(self.to_xarray(), path, engine)


def described_as(dataset: xr.Dataset, result: Any) -> xr.Dataset:
    """Return the dataset with the kind of its result, and how that was called."""
    dataset = dataset if result.call is None else result.call.on(dataset)
    return marked(dataset, result.kind)
