"""Results as netCDF files or zarr stores."""

from __future__ import annotations

import os
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fpsolve.errors import FileFormatError
from fpsolve.io.atomic import atomic_path
from fpsolve.io.dataset import from_xarray, to_xarray
from fpsolve.paths import Paths
from fpsolve.solution import Solution

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["ENGINES", "check_engine", "load", "save"]

ENGINES = ("h5netcdf", "zarr")

# The first bytes of every HDF5 file, hence of netCDF-4.
_SIGNATURE = b"\x89HDF\r\n\x1a\n"


def save(
    result: Solution | Paths, path: str | os.PathLike[str], engine: str | None = None
) -> Path:
    """Write a result to a file that holds everything needed to repeat the run.

    The file appears complete or not at all: an older one of the same name stays as it
    was until the new one is written. Arrays are stored bit for bit.

    Parameters
    ----------
    result : Solution or Paths
    path : str or os.PathLike
        Final place; its folder must exist.
    engine : {"h5netcdf", "zarr"}, optional
        netCDF-4 or zarr; by default zarr for a path that ends in ".zarr".

    Returns
    -------
    Path
        The path written.

    Raises
    ------
    ValueError
        If the engine is unknown.
    ImportError
        If zarr is asked for and not installed.
    FileNotFoundError, IsADirectoryError
        If the folder does not exist, or the path is a folder of something else.
    """
    path = Path(path)
    engine = _engine_of(path) if engine is None else engine
    check_engine(engine)
    dataset = to_xarray(result)
    with atomic_path(path) as draft:
        if engine == "zarr":
            dataset.to_zarr(draft, mode="w", consolidated=False)
        else:
            dataset.to_netcdf(draft, engine="h5netcdf", encoding=_encoding(dataset))
    return path


def load(path: str | os.PathLike[str]) -> Solution | Paths:
    """Read what `save` wrote, a solution or paths; arrays come back bit for bit.

    Parameters
    ----------
    path : str or os.PathLike
        A netCDF file or a zarr store.

    Raises
    ------
    FileNotFoundError
        If there is nothing at `path`.
    FileFormatError
        If the file is truncated, damaged, or not a result of fpsolve.
    ImportError
        If it is a zarr store and zarr is not installed.

    Warns
    -----
    UserWarning
        If the model was made of a user's own functions; `model` is None then. The
        same holds for a law of the start, `initial`.
    """
    path = Path(path)
    if not path.exists():
        raise FileNotFoundError(f"`path` must exist to be read, got `{path}`.")
    engine = "zarr" if path.is_dir() else "h5netcdf"
    check_engine(engine)
    if path.is_file() and not _has_signature(path):
        raise FileFormatError(path, "it is not a netCDF-4 file")
    try:
        return from_xarray(_read(path, engine))
    except UserWarning:
        # Raised by warnings that a caller turned into errors.
        raise
    # A damaged file makes the libraries below raise whatever they come across.
    except Exception as error:
        reason = str(error).rstrip(".") or type(error).__name__
        raise FileFormatError(path, reason) from error


def check_engine(engine: str) -> None:
    """Raise unless `engine` is known and installed."""
    if engine not in ENGINES:
        known = ", ".join(repr(name) for name in ENGINES)
        raise ValueError(f"`engine` must be one of {known}, got {engine!r}.")
    if engine == "zarr" and find_spec("zarr") is None:
        raise ImportError(
            "the engine 'zarr' needs the package zarr; install it with "
            "`pip install 'fpsolve[zarr]'`, or save to netCDF."
        )


def _engine_of(path: Path) -> str:
    return "zarr" if path.suffix == ".zarr" else "h5netcdf"


def _has_signature(path: Path) -> bool:
    with path.open("rb") as file:
        return file.read(len(_SIGNATURE)) == _SIGNATURE


def _read(path: Path, engine: str) -> xr.Dataset:
    import xarray as xr

    # No value is to be decoded: every array is stored as it is.
    options: dict[str, Any] = {"mask_and_scale": False, "decode_times": False}
    if engine == "zarr":
        options["consolidated"] = False
    with xr.open_dataset(path, engine=engine, **options) as dataset:
        return dataset.load()


def _encoding(dataset: xr.Dataset) -> dict[Any, dict[str, Any]]:
    # xarray would announce NaN as a missing value, which it is not here. Densities
    # are not compressed: all 52 bits matter, and zlib gains a seventh at most. Most
    # counts of a histogram are zero, and there it gains all but a few per cent.
    return {
        name: {"_FillValue": None, **_compression(variable)}
        for name, variable in dataset.variables.items()
    }


def _compression(variable: xr.Variable) -> dict[str, Any]:
    if variable.dtype.kind != "i" or variable.ndim < 2 or not variable.size:
        return {}
    return {"zlib": True, "complevel": 1}
