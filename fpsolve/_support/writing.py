"""Write the dataset of a study."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from fpsolve._support.checksums import stamped
from fpsolve._support.files import atomic_path, check_room

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["write_dataset"]


def write_dataset(dataset: xr.Dataset, path: str | os.PathLike[str]) -> Path:
    """Write a dataset to netCDF, or to zarr for a path that ends in .zarr.

    It appears complete or not at all, with checksums that `read_dataset` verifies.

    Parameters
    ----------
    dataset : xarray.Dataset
    path : str or os.PathLike
        Final place; its folder must exist.
    """
    path = Path(path)
    with atomic_path(path) as draft:
        if path.suffix == ".zarr":
            stamped(dataset).to_zarr(draft, mode="w", consolidated=False)
        else:
            check_room(path, dataset.nbytes, draft)
            stamped(dataset).to_netcdf(draft, engine="h5netcdf")
    return path
