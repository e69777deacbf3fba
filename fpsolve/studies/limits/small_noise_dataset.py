"""A small-noise study as a labelled `xarray.Dataset`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.labels import labels, made_with, marked, to_json
from fpsolve.model.potentials.dictionaries import potential_to_dict
from fpsolve.model.potentials.potential import Potential
from fpsolve.studies.limits.energy_law import N_FUNCTIONS
from fpsolve.studies.limits.orders import observed_orders
from fpsolve.studies.sweeps.sweep import Case

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["small_noise_dataset"]

Array = NDArray[np.float64]

_LAWS = {
    "start_law": "law of G at the start, smoothed",
    "averaged_law": "law of G by the averaged equation (16), smoothed",
    "solver_law": "law of G by the full equation, smoothed",
    "paths_law": "law of G by paths, smoothed",
    "paths_error": "standard error of the law by paths",
}
_NUMBERS = {
    "distance": "distance between the laws by the full and the averaged equation",
    "distance_error": "error of the cells in the law by the full equation, at most",
    "mean": "E G by the full equation",
    "exact_mean": "E G on a belt at rest, exact",
    "second_moment": "E G² by the full equation",
    "averaged_second_moment": "E G² by the averaged equation",
    "paths_distance": "distance between the laws by paths and averaged equation",
    "paths_distance_by_chance": "distance expected of paths if there were none",
    "paths_z": "largest deviation of paths from the solver in standard errors",
    "boundary_mass": "largest mass at the edge of the box",
    "s_end": "arclength s",
}


def small_noise_dataset(
    potential: Potential,
    scales: Array,
    noises: Array,
    cases: Sequence[Case],
    options: Mapping[str, Any],
) -> xr.Dataset:
    """Every number over (belt_speed_scale, noise), the laws also over `function`.

    Parameters
    ----------
    potential : Potential
    scales, noises : ndarray
    cases : sequence of Case
        In the order of scales, then noises.
    options : mapping
        What the cases have in common.
    """
    import xarray as xr

    shape = (len(scales), len(noises))
    over = ("belt_speed_scale", "noise")
    variables: dict[str, Any] = {
        name: (over, _table(cases, name).reshape(shape), labels(meaning))
        for name, meaning in _NUMBERS.items()
    }
    for name, meaning in _LAWS.items():
        table = _table(cases, name, N_FUNCTIONS).reshape(*shape, N_FUNCTIONS)
        variables[name] = ((*over, "function"), table, labels(meaning))
    orders = [observed_orders(noises**2, row) for row in variables["distance"][1]]
    told = labels("order of the distance in A², from the noise before")
    variables["observed_order"] = (over, np.array(orders), told)
    for name in ("status", "message"):
        table = np.array([getattr(case, name) for case in cases], dtype=object)
        variables[name] = (over, table.reshape(shape))
    seconds = np.array([case.seconds for case in cases]).reshape(shape)
    variables["seconds"] = (over, seconds, {"long_name": "wall time", "units": "s"})
    coordinates = {
        "belt_speed_scale": ("belt_speed_scale", scales, labels("w = v/A²")),
        "noise": ("noise", noises, labels("noise amplitude A")),
        "epsilon": ("noise", noises**2, labels("ε = A²")),
    }
    dataset = xr.Dataset(variables, coordinates, _attributes(potential, options))
    return marked(dataset, "small-noise")


def _table(cases: Sequence[Case], name: str, size: int = 1) -> Array:
    """One number, or several, of every case; NaN where there are none."""
    nothing = np.full(size, np.nan)
    rows = [np.atleast_1d(case.values.get(name, nothing)) for case in cases]
    return np.array(rows, dtype=np.float64)


def _attributes(potential: Potential, options: Mapping[str, Any]) -> dict[str, Any]:
    described = {**options, "law": options["law"].to_dict()}
    return {
        "title": "Law of G: full equation against averaged equation",
        "potential": to_json(potential_to_dict(potential)),
        "formula": potential.formula,
        "expected_order": 1.0,
        "options": to_json(described),
        **made_with(),
    }
