"""A result of any kind from its file."""

from __future__ import annotations

import os
from typing import Any

from fpsolve._support.netcdf import read_dataset, reported_damage
from fpsolve.results.kinds import from_xarray, kind_of

__all__ = ["load", "opened"]


def load(path: str | os.PathLike[str]) -> Any:
    """Read a result of any kind that was saved; arrays come back bit for bit.

    Parameters
    ----------
    path : str or os.PathLike
        A netCDF file or a zarr store.

    Returns
    -------
    object
        Of the class that was saved; a study, which is one, as its xarray.Dataset.

    Raises
    ------
    FileNotFoundError
        If there is nothing at `path`.
    FileFormatError
        If the file is truncated, damaged, not a result of fpsolve, or declares more
        than fits into memory.
    ImportError
        If it is a zarr store and zarr is not installed.

    Warns
    -----
    UserWarning
        If the model was made of a user's own functions; `model` is None then. The
        same holds for a law of the start, `initial`.
    """
    dataset = read_dataset(path)
    with reported_damage(path, Exception):
        return from_xarray(dataset)


def opened(result: Any) -> Any:
    """Return the result in a file or in a dataset; a result as it is.

    Raises
    ------
    TypeError
        If it is something else.
    """
    import xarray as xr

    if isinstance(result, (str, os.PathLike)):
        return load(result)
    if isinstance(result, xr.Dataset):
        return from_xarray(result)
    kind_of(result)
    return result
