"""A stationary density as a labelled `xarray.Dataset`."""

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

_AXES = ("xi1", "xi2", "alpha")


def to_xarray(result: Any) -> xr.Dataset:
    """p over (xi1, xi2, alpha), its moments and the estimated errors of all.

    Parameters
    ----------
    result : SteadyState
    """
    import xarray as xr

    splitting = np.array([*result.splitting.values()], dtype=np.float64)
    parts = np.array([*result.errors.values()], dtype=np.float64)
    variables: dict[str, Any] = {
        "density": (_AXES, result.density, labels("stationary density p(ξ₁, ξ₂, α)")),
        "density_l1_error": ((), result.error, labels("estimated L¹ error of p")),
        "part_error": ("part", parts, labels("parts of that error")),
        "splitting": ("quantity", splitting, labels("what one run with ds adds")),
        "residual": ((), result.residual, labels("L¹ rate at which p still changes")),
        "n_applications": ((), result.n_applications, labels("evolutions it took")),
    }
    for name, value in result.moments().items():
        variables[name] = ((), value, labels(long_name(name)))
    for name, value in result.moment_errors.items():
        meaning = labels(f"estimated error of: {long_name(name)}")
        variables[f"{name}_error"] = ((), value, meaning)
    coordinates: dict[str, Any] = {
        name: (name, getattr(result.grid, name), labels(COORDINATES[name]))
        for name in _AXES
    }
    coordinates["part"] = ("part", np.array([*result.errors], dtype=object))
    coordinates["quantity"] = ("quantity", np.array([*result.splitting], dtype=object))
    model = result.model
    attributes = {
        "title": "Stationary density of the fibre lay-down equation",
        **describe_model(
            model, None if model is None else model.equation, result.provenance
        ),
        "grid": to_json(result.grid.to_dict()),
        "ds": result.ds,
        "extrapolated": int(result.extrapolated),
        **origin(result.provenance),
    }
    return described_as(xr.Dataset(variables, coordinates, attributes), result)
