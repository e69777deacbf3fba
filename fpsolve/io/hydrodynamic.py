"""Solutions of the hydrodynamic limit as labelled `xarray.Dataset`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve.io.attributes import describe_model, labels, to_json
from fpsolve.io.variables import COORDINATES, long_name

if TYPE_CHECKING:
    import xarray as xr

    from fpsolve.reduced.hydrodynamic import HydrodynamicSolution

__all__ = ["to_xarray"]

# Where the limit's quantity differs from that of the full equation.
_NAMES = {
    "mass": "mass ∫ 𝒫 dξ",
    "relative_entropy": "relative entropy H(𝒫|𝒫_S)",
    "entropy_dissipation": "entropy dissipation −dH/ds of the discrete equation",
    "minimum": "smallest value of 𝒫",
    "density_l1_error": "estimated error of: L¹ norm of 𝒫",
}


def to_xarray(solution: HydrodynamicSolution) -> xr.Dataset:
    """Densities (s, xi1, xi2), series over s_step, and their estimated errors.

    Parameters
    ----------
    solution : HydrodynamicSolution
    """
    import xarray as xr

    model = solution.limit.model
    coordinates = {
        "s": solution.saved_s,
        "s_step": solution.series["s"],
        "xi1": solution.grid.xi1,
        "xi2": solution.grid.xi2,
    }
    variables: dict[str, Any] = {
        "density": (
            ("s", "xi1", "xi2"),
            solution.densities,
            labels("plane density 𝒫(s, ξ₁, ξ₂) of the hydrodynamic limit"),
        )
    }
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
        attrs={
            "title": "hydrodynamic limit of fibre lay-down",
            **describe_model(model, model.equation, solution.provenance),
            "grid": to_json(solution.grid.to_dict()),
            "method": solution.method,
            "ds": solution.ds,
            "provenance": to_json(solution.provenance),
        },
    )


def _labelled(
    name: str, dimension: str, values: np.ndarray
) -> tuple[str, np.ndarray, dict[str, str]]:
    return dimension, values, labels(_NAMES.get(name) or long_name(name))
