"""A solution as a labelled `xarray.Dataset`, and back."""

from __future__ import annotations

from collections.abc import Mapping
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
from fpsolve.density.layout import check_solution_layout
from fpsolve.density.solution import Solution
from fpsolve.evolution.series import (
    COORDINATES,
    DENSITY,
    START,
    long_name,
    read_errors,
    read_series,
)
from fpsolve.grids.phase_space import PhaseSpaceGrid

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["from_xarray", "to_xarray"]

_TITLE = "Solution of the fibre lay-down Fokker-Planck equation"
_AXES = ("xi1", "xi2", "alpha")
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


def to_xarray(solution: Solution, densities: Any = None) -> xr.Dataset:
    """p(s, ξ1, ξ2, α) and every series as one labelled dataset.

    The densities share memory with the solution. Dimensions: `s` (saved densities),
    `xi1`, `xi2`, `alpha`, and `step` (recorded steps, with the coordinate `s_step`).
    Error estimates, when there are any, are variables that end in `_error`. The
    attributes hold equation, model, grid and scheme (as JSON), `ds`, status, versions
    and date; `provenance` holds the arguments of the run. `initial_density` is there
    unless it is among the saved densities, `reference_density` if one was given: with
    them the run can be repeated.

    Parameters
    ----------
    solution : Solution
    densities : array_like, optional
        Stands in for the densities.

    Returns
    -------
    xarray.Dataset
    """
    import xarray as xr

    if densities is None:
        densities = np.asarray(solution.densities)
    variables: dict[str, Any] = {
        "density": (("s", *_AXES), densities, labels(DENSITY)),
        "entropy_floor": (
            (),
            solution.entropy_floor,
            labels("value that H(p|p_S) tends to on this grid"),
        ),
    }
    for name, start in _start(solution).items():
        variables[name] = (_AXES[: start.ndim], start, labels(START[name]))
    for name, values in solution.series.items():
        if name != "s":
            variables[name] = ("step", values, labels(long_name(name)))
    for name, values in (solution.errors or {}).items():
        dimension = "step" if name in solution.series else "s"
        error = f"{name}_error"
        variables[error] = (dimension, values, labels(long_name(error)))
    return xr.Dataset(variables, _coordinates(solution), _attributes(solution))


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
        **_read_start(dataset, provenance),
    )


def _start(solution: Solution) -> dict[str, Any]:
    """Return what the run began with, unless it is among the saved densities."""
    p0, found = solution.initial_density, {}
    if p0 is not None and not _is_saved(p0, solution):
        found["initial_density"] = p0
    if solution.reference is not None:
        found["reference_density"] = np.asarray(solution.reference)
    return found


def _is_saved(p0: Any, solution: Solution) -> bool:
    saved = _saves_start(solution.saved_s, solution.series["s"])
    return saved and np.array_equal(solution.densities[0], p0)


def _saves_start(saved_s: Any, s: Any) -> bool:
    return bool(saved_s.size and s.size and saved_s[0] == s[0])


def _read_start(dataset: xr.Dataset, provenance: Mapping[str, Any]) -> dict[str, Any]:
    p0 = reference = None
    if "initial_density" in dataset:
        p0 = dataset["initial_density"].values
    # Of an older file it is not known whether the first density was the initial one.
    elif "run" in provenance and _saves_start(
        dataset["s"].values, dataset["s_step"].values
    ):
        p0 = dataset["density"].values[0]
    if "reference_density" in dataset:
        reference = dataset["reference_density"].values
    return {"initial_density": p0, "reference": reference}


def _coordinates(solution: Solution) -> dict[str, Any]:
    values = {
        "s": ("s", solution.saved_s),
        "s_step": ("step", solution.series["s"]),
        **{name: (name, getattr(solution.grid, name)) for name in _AXES},
    }
    return {
        name: (dimension, array, labels(COORDINATES[name]))
        for name, (dimension, array) in values.items()
    }


def _attributes(solution: Solution) -> dict[str, Any]:
    model = solution.model
    equation = None if model is None else model.equation
    return {
        "Conventions": "CF-1.11",
        "title": _TITLE,
        **describe_model(model, equation, solution.provenance),
        "grid": to_json(solution.grid.to_dict()),
        "scheme": to_json(solution.scheme),
        "ds": solution.ds,
        "status": solution.status,
        "message": solution.message,
        **origin(solution.provenance),
    }
