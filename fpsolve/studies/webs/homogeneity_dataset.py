"""The homogeneity study as a labelled `xarray.Dataset`."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.labels import labels
from fpsolve.model.potentials.potential import Potential
from fpsolve.studies.sweeps.study import Column, outcomes, study_dataset, variables_of
from fpsolve.studies.sweeps.sweep import Case

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["homogeneity_dataset"]

_ZONE = ("zone",)
_COLUMNS: dict[str, Column] = {
    "predicted": ("CV without simulation", _ZONE),
    "predicted_error": ("error of `predicted`", _ZONE),
    "simulated": ("CV of laid webs", _ZONE),
    "standard_error": ("standard error of `simulated`", _ZONE),
    "z": ("difference of both CV² over its error", _ZONE),
}
_MEANINGS = {
    "noise": "noise A", "belt_speed": "belt speed v",
    "spacing": "distance d of the spinning positions",
}  # fmt: skip


def homogeneity_dataset(
    potential: Potential,
    axes: Mapping[str, Array],
    zones: Array,
    cases: Sequence[Case],
    about: Mapping[str, Any],
) -> xr.Dataset:
    """The cases of a study as a Dataset; NaN where there is none."""
    over = tuple(axes)
    known = {tuple(case.arguments[name] for name in over): case for case in cases}
    places = [tuple(map(float, one)) for one in itertools.product(*axes.values())]
    placed = np.array([known.get(place) for place in places], dtype=object)
    placed = placed.reshape([len(axis) for axis in axes.values()])
    variables = variables_of(placed, over, _COLUMNS, {"zone": len(zones)})
    variables |= outcomes(placed, over)
    coordinates = {
        name: (name, values, labels(_MEANINGS[name])) for name, values in axes.items()
    }
    coordinates["zone"] = ("zone", zones, labels("side of the zone"))
    title = "Variation of laid webs and of their prediction"
    return study_dataset(
        "web-homogeneity", title, potential, variables, coordinates, about
    )
