"""How a stationary density is stored."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fpsolve._support.labels import labels
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

__all__ = ["STATIONARY", "Named"]


@dataclass(frozen=True)
class Named(Part):
    """A mapping of floats: one variable over their names."""

    name: str
    over: str
    words: str
    field: str

    @property
    def needed(self) -> tuple[str, ...]:
        """The numbers and their names."""
        return self.name, self.over

    def write(self, result: Any) -> Stored:
        """The numbers over their names."""
        numbers = getattr(result, self.field)
        values = np.array([*numbers.values()], dtype=np.float64)
        names = np.array([*numbers], dtype=object)
        return {self.name: (self.over, values, labels(self.words)),
                self.over: (self.over, names)}  # fmt: skip

    def read(self, source: Source) -> dict[str, Any]:
        """The mapping."""
        check_dimensions(source.dataset, self.name, (self.over,))
        names, values = (source.dataset[one].values for one in (self.over, self.name))
        pairs = zip(names, values, strict=True)
        return {self.field: {str(name): float(value) for name, value in pairs}}


class _Moments(Part):
    """Moments of the density, written only, and the errors that are known of them."""

    def write(self, result: Any) -> Stored:
        errors = {f"{name}_error": error for name, error in
                  result.moment_errors.items()}  # fmt: skip
        return {
            name: ((), value, labels(long_name(name)))
            for name, value in {**result.moments(), **errors}.items()
        }

    def read(self, source: Source) -> dict[str, Any]:
        known = [name for name in SMOOTH_MOMENTS if f"{name}_error" in source.dataset]
        errors = {name: float(source.dataset[f"{name}_error"]) for name in known}
        return {"moment_errors": errors}


STATIONARY = Layout(
    "Stationary density of the fibre lay-down equation",
    Model(),
    OnGrid(grid_from_dict, "stationary density p(ξ₁, ξ₂, α)", "density", over=()),
    Variable("density_l1_error", (), "estimated L¹ error of p", "error", float),
    Named("part_error", "part", "parts of that error", "errors"),
    Named("splitting", "quantity", "what one run with ds adds", "splitting"),
    Variable("residual", (), "L¹ rate at which p still changes", kind=float),
    Variable("n_applications", (), "evolutions it took", kind=int),
    _Moments(),
    STEP,
    Attribute("extrapolated", write_as=int, read_as=bool),
)  # fmt: skip
