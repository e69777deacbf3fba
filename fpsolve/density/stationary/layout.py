"""How a stationary density is stored."""

from __future__ import annotations

from typing import Any

from fpsolve._support.labels import labels
from fpsolve.evolution.layout import (
    Attribute,
    Layout,
    Named,
    Part,
    Source,
    Variable,
    Variables,
)
from fpsolve.evolution.parts import STEP, Model, OnGrid
from fpsolve.evolution.series import long_name
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.row_sums import MOMENTS

__all__ = ["STATIONARY"]


class Moments(Part):
    """Moments of the density, written only, and the errors that are known of them."""

    def variables(self, result: Any) -> Variables:
        """A variable for every moment, and one for every error."""
        errors = {f"{name}_error": value for name, value in
                  result.moment_errors.items()}  # fmt: skip
        return {
            name: ((), value, labels(long_name(name)))
            for name, value in {**result.moments(), **errors}.items()
        }

    def read(self, source: Source) -> dict[str, Any]:
        """The errors."""
        known = [name for name in MOMENTS if f"{name}_error" in source.dataset]
        errors = {name: float(source.dataset[f"{name}_error"]) for name in known}
        return {"moment_errors": errors}


STATIONARY = Layout(
    "Stationary density of the fibre lay-down equation",
    Model(),
    OnGrid(PhaseSpaceGrid, ("xi1", "xi2", "alpha"),
           "stationary density p(ξ₁, ξ₂, α)", "density", over=()),
    Variable("density_l1_error", (), "estimated L¹ error of p", "error", float),
    Named("part_error", "part", "parts of that error", "errors"),
    Named("splitting", "quantity", "what one run with ds adds", "splitting"),
    Variable("residual", (), "L¹ rate at which p still changes", kind=float),
    Variable("n_applications", (), "evolutions it took", kind=int),
    Moments(),
    STEP,
    Attribute("extrapolated", write=int, make=bool),
)  # fmt: skip
