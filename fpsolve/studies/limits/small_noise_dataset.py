"""A small-noise study as a labelled `xarray.Dataset`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.labels import labels, to_json
from fpsolve.model.potentials.potential import Potential
from fpsolve.studies.limits.energy_law import N_FUNCTIONS
from fpsolve.studies.limits.orders import observed_orders
from fpsolve.studies.sweeps.study import Column, outcomes, study_dataset, variables_of
from fpsolve.studies.sweeps.sweep import Case

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["small_noise_dataset"]

_OF_LAWS = ("function",)
# What a case returns.
_COLUMNS: dict[str, Column] = {
    "distance": ("distance between the laws by the full and the averaged equation", ()),
    "distance_error": (
        "error of the cells in the law by the full equation, at most", (),
    ),
    "mean": ("E G by the full equation", ()),
    "exact_mean": ("E G on a belt at rest, exact", ()),
    "second_moment": ("E G² by the full equation", ()),
    "averaged_second_moment": ("E G² by the averaged equation", ()),
    "paths_distance": ("distance between the laws by paths and averaged equation", ()),
    "paths_distance_by_chance": ("distance expected of paths if there were none", ()),
    "paths_z": ("largest deviation of paths from the solver in standard errors", ()),
    "boundary_mass": ("largest mass at the edge of the box", ()),
    "s_end": ("arclength s", ()),
    "start_law": ("law of G at the start, smoothed", _OF_LAWS),
    "averaged_law": ("law of G by the averaged equation (16), smoothed", _OF_LAWS),
    "solver_law": ("law of G by the full equation, smoothed", _OF_LAWS),
    "paths_law": ("law of G by paths, smoothed", _OF_LAWS),
    "paths_error": ("standard error of the law by paths", _OF_LAWS),
}  # fmt: skip


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
    placed = np.array(cases, dtype=object).reshape(len(scales), len(noises))
    over = ("belt_speed_scale", "noise")
    variables = variables_of(placed, over, _COLUMNS, {"function": N_FUNCTIONS})
    orders = [observed_orders(noises**2, row) for row in variables["distance"][1]]
    told = labels("order of the distance in A², from the noise before")
    variables["observed_order"] = (over, np.array(orders), told)
    variables |= outcomes(placed, over)
    coordinates = {
        "belt_speed_scale": ("belt_speed_scale", scales, labels("w = v/A²")),
        "noise": ("noise", noises, labels("noise amplitude A")),
        "epsilon": ("noise", noises**2, labels("ε = A²")),
    }
    described = {**options, "law": options["law"].to_dict()}
    about = {"expected_order": 1.0, "options": to_json(described)}
    title = "Law of G: full equation against averaged equation"
    return study_dataset("small-noise", title, potential, variables, coordinates, about)
