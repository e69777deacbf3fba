"""A solution of the hydrodynamic limit from the dataset that describes it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fpsolve._support.declared import declared
from fpsolve._support.labels import check_complete
from fpsolve.evolution.call import Call
from fpsolve.evolution.layout import check_plane_layout
from fpsolve.evolution.series import read_errors, read_series
from fpsolve.grids.plane import PlaneGrid
from fpsolve.model.stored import read_model
from fpsolve.reduced.hydrodynamic.limit import HydrodynamicLimit
from fpsolve.reduced.hydrodynamic.solution import HydrodynamicSolution

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["from_xarray"]

_NEEDED = ("s", "s_step", "density")
_NEEDED_ATTRIBUTES = ("model", "grid", "method", "ds", "status", "provenance")


def from_xarray(dataset: xr.Dataset) -> HydrodynamicSolution:
    """Return the solution that `to_xarray` turned into `dataset`, bit for bit.

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
        If the model was made of a user's own functions; `limit` is None then.
    """
    check_complete(dataset, _NEEDED, _NEEDED_ATTRIBUTES)
    attributes = declared(dataset.attrs)
    provenance = attributes["provenance"]
    grid = PlaneGrid.from_dict(attributes["grid"])
    check_plane_layout(dataset, grid, attributes)
    model = read_model(attributes, provenance)
    start = dataset["initial_density"].values if "initial_density" in dataset else None
    return HydrodynamicSolution(
        limit=None if model is None else HydrodynamicLimit(model),
        grid=grid,
        method=attributes["method"],
        ds=float(attributes["ds"]),
        series=read_series(dataset, "s_step"),
        saved_s=dataset["s"].values,
        densities=dataset["density"].values,
        errors=read_errors(dataset) or None,
        provenance=provenance,
        initial_density=start,
        status=attributes["status"],
        call=Call.from_xarray(dataset),
    )
