"""Paths of the energy process from the dataset that describes them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fpsolve._support.declared import declared
from fpsolve._support.labels import check_complete, read_provenance
from fpsolve.evolution.call import Call
from fpsolve.evolution.layout import check_dimensions, check_increasing, check_step
from fpsolve.reduced.energy.reading import read_process
from fpsolve.reduced.energy.sampling import EnergyPaths

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["from_xarray"]

_NEEDED_ATTRIBUTES = ("potential", "noise", "ds", "seed", "method", "provenance")


def from_xarray(dataset: xr.Dataset) -> EnergyPaths:
    """Return the paths that `to_xarray` turned into `dataset`, bit for bit.

    Parameters
    ----------
    dataset : xarray.Dataset

    Raises
    ------
    ValueError
        If the dataset does not have the layout of `to_xarray`.

    Warns
    -----
    UserWarning
        If the potential was a user's own code; `process` is None then.
    """
    check_complete(dataset, ("s", "energy"), _NEEDED_ATTRIBUTES)
    check_dimensions(dataset, {"s": ("s",), "energy": ("s", "path")})
    check_increasing("s", dataset["s"].values)
    about = declared(dataset.attrs)
    check_step(about["ds"])
    provenance = read_provenance(about)
    return EnergyPaths(
        s=dataset["s"].values,
        g=dataset["energy"].values,
        ds=float(about["ds"]),
        seed=int(about["seed"]),
        method=about["method"],
        process=read_process(about, provenance),
        call=Call.from_xarray(dataset),
        provenance=provenance,
    )
