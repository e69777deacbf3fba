"""How a time-periodic density is stored."""

from __future__ import annotations

from typing import Any

import numpy as np

from fpsolve._support.labels import labels
from fpsolve.density.stationary.layout import Named
from fpsolve.evolution.layout import (
    Attribute,
    Layout,
    Part,
    Source,
    Stored,
    Variable,
    check_dimensions,
)
from fpsolve.evolution.parts import STEP, Model, OnGrid
from fpsolve.evolution.series import long_name
from fpsolve.grids.dictionaries import grid_from_dict
from fpsolve.grids.smooth_sums import SMOOTH_MOMENTS

__all__ = ["PERIODIC"]


def checked_period(period: Any) -> float:
    """The period; ValueError unless it is positive."""
    if not 0 < float(period) < np.inf:
        raise ValueError(f"`period` must be positive, got {float(period):g}")
    return float(period)


class _Moments(Part):
    """Moments at every phase, written only, and the errors that are known of them."""

    def write(self, result: Any) -> Stored:
        errors = {f"{name}_error": error for name, error in
                  result.moment_errors.items()}  # fmt: skip
        return {
            name: ("s", np.asarray(values), labels(long_name(name)))
            for name, values in {**result.moments(), **errors}.items()
        }

    def read(self, source: Source) -> dict[str, Any]:
        known = [name for name in SMOOTH_MOMENTS if f"{name}_error" in source.dataset]
        for name in known:
            check_dimensions(source.dataset, f"{name}_error", ("s",))
        errors = {name: source.dataset[f"{name}_error"].values for name in known}
        return {"moment_errors": errors}


PERIODIC = Layout(
    "Time-periodic density of the fibre lay-down equation",
    Model(),
    Variable("s", ("s",), "arclength s within the period", increasing=True),
    OnGrid(grid_from_dict, "periodic density p(ξ₁, ξ₂, α; s)"),
    Variable("density_l1_error", ("s",), "estimated L¹ error of p", "phase_errors"),
    Variable("plane_error", ("plane_part", "s", "xi1", "xi2"),
             "estimated error of ∫ p dα by step, grid and iteration", "plane_errors"),
    Named("part_error", "part", "parts of the largest of these", "errors"),
    Variable("residual", (), "L¹ rate at which p changes from period to period",
             kind=float),
    Variable("n_applications", (), "evolutions it took", kind=int),
    _Moments(),
    STEP,
    Attribute("period", read_as=checked_period),
)  # fmt: skip
