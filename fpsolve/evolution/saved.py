"""What every result shares that can be saved."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

from fpsolve._support.netcdf import write_dataset
from fpsolve.evolution.layout import Layout

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Saved", "restored"]

Result = TypeVar("Result", bound="Saved")


class Saved:
    """A result that a labelled Dataset holds whole, as its `layout` says."""

    kind: ClassVar[str]
    layout: ClassVar[Layout]

    def to_xarray(self) -> xr.Dataset:
        """Return the result as a labelled Dataset, from which `load` makes it again."""
        return self.layout.dataset(self)

    def save(self, path: str | Path, engine: str | None = None) -> Path:
        """Write the result to netCDF, or to zarr for a path that ends in .zarr."""
        return write_dataset(self.to_xarray(), path, engine)


def restored(
    kind: type[Result], dataset: xr.Dataset, **owners: Callable[..., Any]
) -> Result:
    """Return the result that its `to_xarray` turned into a dataset, bit for bit.

    Parameters
    ----------
    kind : type
        Class of the result.
    dataset : xarray.Dataset
    **owners : callable
        What makes a field whose class stands above that of the result.

    Raises
    ------
    ValueError
        If the dataset has not the layout of the class.

    Warns
    -----
    UserWarning
        If a model was made of a user's own functions; it is None then.
    """
    return kind(**kind.layout.read(dataset, owners))
