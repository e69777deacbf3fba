"""From a file, or a result, to the dataset that is compared."""

from __future__ import annotations

import os
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fpsolve._support.netcdf import read_dataset, reported_damage
from fpsolve.results.kinds import from_xarray, kind_of

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["dataset_of", "kind_of_dataset", "name_of"]


def name_of(result: Any, otherwise: str) -> str:
    """Return the name of a file, without its folder, or another word."""
    if isinstance(result, (str, os.PathLike)):
        return Path(result).name
    return otherwise


def dataset_of(result: Any, argument: str) -> xr.Dataset:
    """Return a result of any kind as a dataset.

    Raises
    ------
    FileNotFoundError, FileFormatError
        If a file does not exist, is damaged, or holds something else.
    ValueError, TypeError
        If it is no result of fpsolve.
    """
    import xarray as xr

    if isinstance(result, (str, os.PathLike)):
        path, result = result, read_dataset(result)
        # A file that `load` would not read is not compared either.
        with reported_damage(path, Exception), warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)
            from_xarray(result)
    elif not isinstance(result, xr.Dataset):
        kind_of(result)
        result = result.to_xarray()
    kind_of_dataset(result, argument)
    found: xr.Dataset = result
    return found


def kind_of_dataset(dataset: xr.Dataset, argument: str) -> str:
    """Return the key of `KINDS`; ValueError unless it is a result of fpsolve."""
    try:
        return kind_of(dataset)
    except ValueError as error:
        raise ValueError(
            f"`{argument}` must be a result of fpsolve, got another dataset: {error}."
        ) from None
