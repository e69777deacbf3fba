"""Solutions of the hydrodynamic limit as labelled `xarray.Dataset`, and back."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.declared import declared
from fpsolve._support.labels import (
    check_complete,
    describe_model,
    labels,
    origin,
    read_model,
    to_json,
)
from fpsolve.density.layout import check_plane_layout
from fpsolve.evolution.series import COORDINATES, long_name, read_errors, read_series
from fpsolve.grids.plane import PlaneGrid
from fpsolve.reduced.hydrodynamic import HydrodynamicLimit, HydrodynamicSolution

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["from_xarray", "to_xarray"]

# Where the limit's quantity differs from that of the full equation.
_NAMES = {
    "mass": "mass ∫ 𝒫 dξ",
    "relative_entropy": "relative entropy H(𝒫|𝒫_S)",
    "entropy_dissipation": "entropy dissipation −dH/ds of the discrete equation",
    "minimum": "smallest value of 𝒫",
    "density_l1_error": "estimated error of: L¹ norm of 𝒫",
}
_NEEDED = ("s", "s_step", "density")
_NEEDED_ATTRIBUTES = ("model", "grid", "method", "ds", "status", "provenance")
_PLANE = ("xi1", "xi2")


def to_xarray(solution: HydrodynamicSolution) -> xr.Dataset:
    """Densities (s, xi1, xi2), series over s_step, and their estimated errors.

    Parameters
    ----------
    solution : HydrodynamicSolution
    """
    import xarray as xr

    coordinates = {
        "s": solution.saved_s,
        "s_step": solution.series["s"],
        "xi1": solution.grid.xi1,
        "xi2": solution.grid.xi2,
    }
    variables: dict[str, Any] = {
        "density": (
            ("s", *_PLANE),
            solution.densities,
            labels("plane density 𝒫(s, ξ₁, ξ₂) of the hydrodynamic limit"),
        )
    }
    if solution.initial_density is not None:
        meaning = labels("plane density 𝒫₀ of the start")
        variables["initial_density"] = (_PLANE, solution.initial_density, meaning)
    for name, values in solution.series.items():
        if name != "s":
            variables[name] = _labelled(name, "s_step", values)
    for name, values in (solution.errors or {}).items():
        dimension = "s" if name == "density_l1" else "s_step"
        variables[f"{name}_error"] = _labelled(f"{name}_error", dimension, values)
    return xr.Dataset(
        variables,
        coords={
            name: (name, values, labels(COORDINATES[name]))
            for name, values in coordinates.items()
        },
        attrs=_attributes(solution),
    )


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
    )


def _attributes(solution: HydrodynamicSolution) -> dict[str, Any]:
    # Files may come without a model.
    model = None if solution.limit is None else solution.limit.model
    equation = None if model is None else model.equation
    return {
        "title": "hydrodynamic limit of fibre lay-down",
        **describe_model(model, equation, solution.provenance),
        "grid": to_json(solution.grid.to_dict()),
        "method": solution.method,
        "ds": solution.ds,
        "status": solution.status,
        **origin(solution.provenance),
    }


def _labelled(
    name: str, dimension: str, values: np.ndarray
) -> tuple[str, np.ndarray, dict[str, str]]:
    return dimension, values, labels(_NAMES.get(name) or long_name(name))
