"""Paths of the hydrodynamic limit from the dataset that describes them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fpsolve._support.declared import declared
from fpsolve._support.labels import check_complete, read_provenance
from fpsolve.evolution.call import Call
from fpsolve.evolution.layout import check_dimensions, check_increasing
from fpsolve.model.stored import read_model
from fpsolve.reduced.hydrodynamic.sampling import HydrodynamicPaths

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["from_xarray"]


def from_xarray(dataset: xr.Dataset) -> HydrodynamicPaths:
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
        If the model was made of a user's own functions; `model` is None then.
    """
    check_complete(dataset, ("s", "xi"), ("model", "method", "ds", "provenance"))
    check_dimensions(dataset, {"s": ("s",), "xi": ("s", "path", "component")})
    check_increasing("s", dataset["s"].values)
    about = declared(dataset.attrs)
    provenance = read_provenance(about)
    return HydrodynamicPaths(
        s=dataset["s"].values,
        xi=dataset["xi"].values,
        method=about["method"],
        ds=float(about["ds"]),
        model=read_model(about, provenance),
        call=Call.from_xarray(dataset),
        provenance=provenance,
    )
