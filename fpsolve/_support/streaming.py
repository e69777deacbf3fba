"""Densities that go from a checkpoint to a result one by one."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from fpsolve._support.checksums import CHECKSUMS, digest_of, with_digest
from fpsolve._support.labels import labels
from fpsolve.density import dataset as solutions
from fpsolve.density.solution import Solution
from fpsolve.evolution.series import DENSITY
from fpsolve.evolution.stored import LazyDensities
from fpsolve.results.kinds import marked

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["append_densities", "lazy_densities", "without_densities"]

_DIMENSIONS = ("s", "xi1", "xi2", "alpha")


def lazy_densities(solution: Solution) -> LazyDensities | None:
    """Return the densities if they are on the disk."""
    densities = cast(Any, solution.densities)
    return densities if isinstance(densities, LazyDensities) else None


def without_densities(solution: Solution) -> xr.Dataset:
    """Return the dataset of a solution but for `density`."""
    # One number in the place of all, which takes no memory.
    nothing = np.broadcast_to(np.float64(0.0), solution.densities.shape)
    dataset = solutions.to_xarray(solution, nothing)
    return marked(dataset.drop_vars("density"), "solution")


def append_densities(draft: Path, engine: str, densities: LazyDensities) -> None:
    """Add `density` to a file that holds the rest of the dataset."""
    if engine == "zarr":
        _append_to_zarr(draft, densities)
    else:
        _append_to_netcdf(draft, densities)


def _append_to_netcdf(draft: Path, densities: LazyDensities) -> None:
    import h5netcdf

    with h5netcdf.File(draft, "a") as file:
        variable = file.create_variable("density", _DIMENSIONS, densities.dtype)
        variable.attrs.update(labels(DENSITY))
        for index, p in enumerate(densities):
            variable[index] = p
        file.attrs[CHECKSUMS] = _complete(file.attrs[CHECKSUMS], densities)


def _append_to_zarr(draft: Path, densities: LazyDensities) -> None:
    import zarr

    attributes: dict[str, Any] = {**labels(DENSITY)}
    group = zarr.open_group(draft, mode="r+")
    array = group.create_array(
        "density",
        shape=densities.shape,
        chunks=(1, *densities.shape[1:]),
        dtype=densities.dtype,
        fill_value=float("nan"),
        dimension_names=_DIMENSIONS,
        attributes=attributes,
    )
    for index, p in enumerate(densities):
        array[index] = p
    group.attrs[CHECKSUMS] = _complete(str(group.attrs[CHECKSUMS]), densities)


def _complete(checksums: str, densities: LazyDensities) -> str:
    """Return the checksums with that of the densities."""
    labelled = labels(DENSITY)
    about = "density", _DIMENSIONS, densities.shape, densities.dtype, labelled
    return with_digest(checksums, "density", digest_of(*about, densities))
