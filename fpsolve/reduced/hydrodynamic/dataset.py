"""A solution of the hydrodynamic limit as a labelled `xarray.Dataset`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.labels import labels, origin, to_json
from fpsolve.evolution.saved import described_as
from fpsolve.evolution.series import COORDINATES, long_name
from fpsolve.model.stored import describe_model

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["to_xarray"]

# Where the limit's quantity differs from that of the full equation.
_NAMES = {
    "mass": "mass ∫ 𝒫 dξ",
    "relative_entropy": "relative entropy H(𝒫|𝒫_S)",
    "entropy_dissipation": "entropy dissipation −dH/ds of the discrete equation",
    "minimum": "smallest value of 𝒫",
    "density_l1_error": "estimated error of: L¹ norm of 𝒫",
}
_PLANE = ("xi1", "xi2")


def to_xarray(solution: Any) -> xr.Dataset:
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
    dataset = xr.Dataset(
        variables,
        coords={
            name: (name, values, labels(COORDINATES[name]))
            for name, values in coordinates.items()
        },
        attrs=_attributes(solution),
    )
    return described_as(dataset, solution)


def _attributes(solution: Any) -> dict[str, Any]:
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
