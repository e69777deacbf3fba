"""A solution from the labelled `xarray.Dataset` that describes it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fpsolve._support.declared import declared
from fpsolve._support.labels import check_complete
from fpsolve.density.dataset import saves_start
from fpsolve.density.solution import Solution
from fpsolve.evolution.call import CALL, Call
from fpsolve.evolution.layout import check_solution_layout
from fpsolve.evolution.series import read_errors, read_series
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.stored import read_model

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["from_xarray"]

_NEEDED = ("s", "s_step", "density", "entropy_floor")
_NEEDED_ATTRIBUTES = (
    "model",
    "grid",
    "scheme",
    "ds",
    "status",
    "message",
    "provenance",
)


def from_xarray(dataset: xr.Dataset) -> Solution:
    """Return the solution that `to_xarray` turned into `dataset`.

    Arrays come back bit for bit. A model made of a user's own functions cannot be
    read back: `model` is None then, and its description and equation are in
    `provenance`.

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
        If the model could not be read back.
    """
    check_complete(dataset, _NEEDED, _NEEDED_ATTRIBUTES)
    attributes = declared(dataset.attrs)
    provenance = attributes["provenance"]
    model = read_model(attributes, provenance)
    errors = read_errors(dataset)
    grid = PhaseSpaceGrid.from_dict(attributes["grid"])
    scheme = attributes["scheme"]
    check_solution_layout(dataset, grid, attributes)
    return Solution(
        model=model,
        grid=grid,
        scheme=scheme,
        ds=float(attributes["ds"]),
        series=read_series(dataset, "step"),
        saved_s=dataset["s"].values,
        densities=dataset["density"].values,
        entropy_floor=float(dataset["entropy_floor"]),
        status=attributes["status"],
        message=attributes["message"],
        errors=errors or None,
        provenance=provenance,
        **_read_start(dataset),
        call=Call.from_xarray(dataset),
    )


def _read_start(dataset: xr.Dataset) -> dict[str, Any]:
    p0 = reference = None
    if "initial_density" in dataset:
        p0 = dataset["initial_density"].values
    # Of one that was put together by hand it is not known.
    elif CALL in dataset.attrs and saves_start(
        dataset["s"].values, dataset["s_step"].values
    ):
        p0 = dataset["density"].values[0]
    if "reference_density" in dataset:
        reference = dataset["reference_density"].values
    return {"initial_density": p0, "reference": reference}
