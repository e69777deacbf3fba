"""Datasets as netCDF files or zarr stores."""

from __future__ import annotations

import gc
import os
import sys
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fpsolve._support.checks import check_path
from fpsolve._support.checksums import covered_variables, stamped, verified
from fpsolve._support.declared import declared
from fpsolve._support.files import atomic_path, check_room
from fpsolve._support.sizes import check_sizes
from fpsolve._support.streaming import Streamed, append
from fpsolve.errors import FileFormatError

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "ENGINES",
    "check_engine",
    "read_dataset",
    "reported_damage",
    "write_dataset",
]

ENGINES = ("h5netcdf", "zarr")

# The first bytes of every HDF5 file, hence of netCDF-4.
_SIGNATURE = b"\x89HDF\r\n\x1a\n"


def write_dataset(
    dataset: xr.Dataset,
    path: str | os.PathLike[str],
    engine: str | None = None,
    streamed: Sequence[Streamed] = (),
) -> Path:
    """Write a dataset to a file, with checksums that `read_dataset` verifies.

    The file appears complete or not at all: an older one of the same name stays as it
    was until the new one is written. Arrays are stored bit for bit.

    Parameters
    ----------
    dataset : xarray.Dataset
    path : str or os.PathLike
        Final place; its folder must exist. A link is followed to the file that it
        names; through a pipe that is read the finished file is written.
    engine : {"h5netcdf", "zarr"}, optional
        netCDF-4 or zarr; by default zarr for a path that ends in ".zarr".
    streamed : sequence of Streamed
        Further variables, which do not fit into memory.

    Returns
    -------
    Path
        The path written.

    Raises
    ------
    ValueError
        If the engine is unknown, or the path is a device, a socket, a link in a circle,
        or a pipe that nobody reads.
    TypeError
        If the path is no path.
    ImportError
        If zarr is asked for and not installed.
    FileNotFoundError, IsADirectoryError
        If the folder does not exist, the path is a link to nothing, or a folder of
        something else.
    """
    path = check_path("path", path)
    engine = _engine_of(path) if engine is None else engine
    check_engine(engine)
    dataset = stamped(dataset)
    with atomic_path(path) as draft:
        if engine == "zarr":
            dataset.to_zarr(draft, mode="w", consolidated=False)
        else:
            needed = _plain_bytes(dataset) + sum(one.nbytes for one in streamed)
            check_room(path, needed, draft)
            dataset.to_netcdf(draft, engine="h5netcdf", encoding=_encoding(dataset))
        for variable in streamed:
            append(draft, engine, variable)
    return path


def read_dataset(path: str | os.PathLike[str]) -> xr.Dataset:
    """Read any dataset that fpsolve writes, of a result or of a study.

    Parameters
    ----------
    path : str or os.PathLike
        A netCDF file or a zarr store.

    Raises
    ------
    FileNotFoundError, FileFormatError, ImportError
        As for `load`. Attributes have the types that fpsolve gives them; what else is
        in the dataset is not looked at.
    """
    path = check_path("path", path)
    if not path.exists():
        raise FileNotFoundError(f"`path` must exist to be read, got `{path}`.")
    engine = "zarr" if path.is_dir() else "h5netcdf"
    check_engine(engine)
    # Of a pipe reading would wait, perhaps for ever.
    if engine == "h5netcdf" and not (path.is_file() and _has_signature(path)):
        raise FileFormatError(
            path, "it is not a netCDF-4 file; name one that fpsolve wrote"
        )
    dataset = _undamaged(path, engine)
    with reported_damage(path, Exception):
        found = verified(dataset)
        declared(found.attrs)
        return found


def _undamaged(path: Path, engine: str) -> xr.Dataset:
    reason = ""
    # What libraries warn of in a damaged file the checksums tell, too.
    with warnings.catch_warnings(), _silent_ends():
        warnings.simplefilter("ignore")
        try:
            return _read(path, engine)
        except FileFormatError:
            raise
        # A damaged file makes the libraries below raise whatever they come across.
        except Exception as error:
            reason = " ".join(str(error).split()).rstrip(".") or type(error).__name__
        # Only now nothing refers to the file that was half opened.
        gc.collect(1)
    raise FileFormatError(
        path,
        f"it is damaged or of another program ({reason}); make it again, or take a "
        "copy",
    )


@contextmanager
def _silent_ends() -> Iterator[None]:
    """Silence what a file that was opened by half says when it is thrown away."""
    before = sys.unraisablehook

    def hook(unraisable: Any) -> None:
        if getattr(unraisable.object, "__qualname__", "") != "File.close":
            before(unraisable)

    sys.unraisablehook = hook
    try:
        yield
    finally:
        sys.unraisablehook = before


@contextmanager
def reported_damage(
    path: str | os.PathLike[str], *kinds: type[Exception]
) -> Iterator[None]:
    """Turn exceptions of these kinds into a `FileFormatError` that names the file."""
    try:
        yield
    except UserWarning:
        # Raised by warnings that a caller turned into errors.
        raise
    except kinds as error:
        reason = " ".join(str(error).split()).rstrip(".") or type(error).__name__
        if isinstance(error, KeyError):
            reason = f"`{error.args[0]}` is missing in it"
        raise FileFormatError(path, reason) from error


def check_engine(engine: str) -> None:
    """Raise unless `engine` is known."""
    if engine not in ENGINES:
        known = ", ".join(repr(name) for name in ENGINES)
        raise ValueError(f"`engine` must be one of {known}, got {engine!r}.")


def _engine_of(path: Path) -> str:
    return "zarr" if path.suffix == ".zarr" else "h5netcdf"


def _has_signature(path: Path) -> bool:
    with path.open("rb") as file:
        return file.read(len(_SIGNATURE)) == _SIGNATURE


def _read(path: Path, engine: str) -> xr.Dataset:
    import xarray as xr

    # No value is to be decoded: every array is stored as it is.
    options: dict[str, Any] = {"mask_and_scale": False, "decode_times": False}
    # An index would be read before its size is known.
    options["create_default_indexes"] = False
    if engine == "zarr":
        options["consolidated"] = False
    with xr.open_dataset(path, engine=engine, **options) as opened:
        covered = covered_variables(opened.attrs)
        if covered is not None:
            opened = opened.drop_vars([one for one in opened.variables
                                       if one not in covered])  # fmt: skip
        check_sizes(path, opened)
        read = opened.load()
        data = {name: read.variables[name] for name in read.data_vars}
        coordinates = {name: read.variables[name] for name in read.coords}
        return xr.Dataset(data, coordinates, read.attrs)


def _encoding(dataset: xr.Dataset) -> dict[Any, dict[str, Any]]:
    # xarray would announce NaN as a missing value, which it is not here. Densities
    # are not compressed: all 52 bits matter, and zlib gains a seventh at most. Most
    # counts of a histogram are zero, and there it gains all but a few per cent.
    return {
        name: {"_FillValue": None, **_compression(variable)}
        for name, variable in dataset.variables.items()
    }


def _plain_bytes(dataset: xr.Dataset) -> int:
    # What is compressed may take next to nothing.
    variables = dataset.variables.values()
    return sum(one.nbytes for one in variables if not _compression(one))


def _compression(variable: xr.Variable) -> dict[str, Any]:
    if variable.dtype.kind != "i" or variable.ndim < 2 or not variable.size:
        return {}
    return {"zlib": True, "complevel": 1}
