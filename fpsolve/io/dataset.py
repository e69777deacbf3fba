"""A solution as a labelled `xarray.Dataset`, and back."""

from __future__ import annotations

import json
import warnings
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve.grids import PhaseSpaceGrid
from fpsolve.io.variables import COORDINATES, DENSITY, long_name
from fpsolve.models import LayDownModel
from fpsolve.solution import Solution

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["FORMAT", "from_xarray", "to_xarray"]

# Number of this layout; raised whenever an older version could misread a file.
FORMAT = 1

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
# Entries of `provenance` that stand in for a model that cannot be read back.
_UNREADABLE = ("model_description", "equation")


def to_xarray(solution: Solution) -> xr.Dataset:
    """p(s, ξ1, ξ2, α) and every series as one labelled dataset.

    The densities share memory with the solution. Dimensions: `s` (saved densities),
    `xi1`, `xi2`, `alpha`, and `step` (recorded steps, with the coordinate `s_step`).
    Error estimates, when there are any, are variables that end in `_error`. The
    attributes hold what is needed to repeat the run: equation, model, grid and scheme
    (as JSON), `ds`, status, versions and date.

    Parameters
    ----------
    solution : Solution

    Returns
    -------
    xarray.Dataset
    """
    import xarray as xr

    variables: dict[str, Any] = {
        "density": (("s", *_AXES), solution.densities, _labels(DENSITY)),
        "entropy_floor": (
            (),
            solution.entropy_floor,
            _labels("value that H(p|p_S) tends to on this grid"),
        ),
    }
    for name, values in solution.series.items():
        if name != "s":
            variables[name] = ("step", values, _labels(long_name(name)))
    for name, values in (solution.errors or {}).items():
        dimension = "step" if name in solution.series else "s"
        error = f"{name}_error"
        variables[error] = (dimension, values, _labels(long_name(error)))
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
    attributes = dataset.attrs
    _check_layout(dataset)
    provenance = json.loads(attributes["provenance"])
    model = _read_model(attributes, provenance)
    errors = _read_errors(dataset)
    return Solution(
        model=model,
        grid=PhaseSpaceGrid.from_dict(json.loads(attributes["grid"])),
        scheme=json.loads(attributes["scheme"]),
        ds=float(attributes["ds"]),
        series=_read_series(dataset),
        saved_s=dataset["s"].values,
        densities=dataset["density"].values,
        entropy_floor=float(dataset["entropy_floor"]),
        status=str(attributes["status"]),
        message=str(attributes["message"]),
        errors=errors or None,
        provenance=provenance,
    )


def _labels(name: str) -> dict[str, str]:
    return {"long_name": name, "units": "1"}


def _coordinates(solution: Solution) -> dict[str, Any]:
    values = {
        "s": ("s", solution.saved_s),
        "s_step": ("step", solution.series["s"]),
        **{name: (name, getattr(solution.grid, name)) for name in _AXES},
    }
    return {
        name: (dimension, array, _labels(COORDINATES[name]))
        for name, (dimension, array) in values.items()
    }


def _attributes(solution: Solution) -> dict[str, Any]:
    provenance = dict(solution.provenance)
    if solution.model is None:
        # Read from a file already: its description goes on as it came.
        description, equation = (provenance.pop(key, "") for key in _UNREADABLE)
    else:
        description = _to_json(solution.model.to_dict())
        equation = solution.model.equation
    return {
        "Conventions": "CF-1.11",
        "title": _TITLE,
        "equation": equation,
        "model": description,
        "grid": _to_json(solution.grid.to_dict()),
        "scheme": _to_json(solution.scheme),
        "ds": solution.ds,
        "status": solution.status,
        "message": solution.message,
        **_flat(provenance),
        "provenance": _to_json(provenance),
        "fpsolve_format": FORMAT,
    }


def _to_json(value: Any) -> str:
    # A user's own potential may hold anything; its repr describes it best.
    return json.dumps(value, default=_plain, ensure_ascii=False)


def _plain(value: Any) -> Any:
    if isinstance(value, np.generic):
        return value.item()
    return value.tolist() if isinstance(value, np.ndarray) else repr(value)


def _flat(provenance: Mapping[str, Any]) -> dict[str, Any]:
    """Versions, date and times, which a reader of the file sees without parsing."""
    versions = provenance.get("versions", {})
    flat = {f"{package}_version": number for package, number in versions.items()}
    if "date" in provenance:
        flat["date_created"] = provenance["date"]
    return flat


def _check_layout(dataset: xr.Dataset) -> None:
    written = dataset.attrs.get("fpsolve_format")
    if written is None:
        raise ValueError(
            "it is not a result of fpsolve (attribute `fpsolve_format` is missing)"
        )
    if int(written) > FORMAT:
        raise ValueError(
            f"it has layout {int(written)}, this version of fpsolve reads up to "
            f"{FORMAT}; update fpsolve"
        )
    missing = [f"`{name}`" for name in _NEEDED if name not in dataset]
    missing += [f"`{name}`" for name in _NEEDED_ATTRIBUTES if name not in dataset.attrs]
    if missing:
        raise ValueError(f"{', '.join(missing)} is missing in it")


def _read_model(
    attributes: Mapping[str, Any], provenance: dict[str, Any]
) -> LayDownModel | None:
    try:
        return LayDownModel.from_dict(json.loads(attributes["model"]))
    except ValueError as error:
        provenance["model_description"] = attributes["model"]
        provenance["equation"] = attributes["equation"]
        warnings.warn(
            f"the model could not be read back, so `model` is None: {error}",
            UserWarning,
            stacklevel=4,
        )
        return None


def _read_series(dataset: xr.Dataset) -> dict[str, Any]:
    series = {"s": dataset["s_step"].values}
    for name, variable in dataset.data_vars.items():
        if variable.dims == ("step",) and not str(name).endswith("_error"):
            series[str(name)] = variable.values
    return series


def _read_errors(dataset: xr.Dataset) -> dict[str, Any]:
    return {
        str(name).removesuffix("_error"): variable.values
        for name, variable in dataset.data_vars.items()
        if str(name).endswith("_error")
    }
