"""How a solution is stored.

Dimensions: `s` (saved densities), the axes of the grid, and `step` (recorded steps,
with the coordinate `s_step`).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fpsolve._support.checks import shown
from fpsolve._support.labels import labels, to_json
from fpsolve.evolution.layout import (
    Attribute,
    Layout,
    Part,
    Source,
    Stored,
    Variable,
    check_dimensions,
)
from fpsolve.evolution.parts import SAVED, STATUS, STEP, Model, OnGrid, Recorded
from fpsolve.evolution.series import DENSITY, START
from fpsolve.grids.dictionaries import grid_from_dict

__all__ = ["SOLUTION", "is_saved"]


class _Start(Part):
    """What the run began with, unless it is the first of the saved densities.

    With it, and the density that the entropy is relative to if one was given, the run
    can be repeated. Over the plane only if they do not depend on the angle.
    """

    def write(self, result: Any) -> Stored:
        p0 = None if is_saved(result) else result.initial_density
        given = {"initial_density": p0, "reference_density": result.reference}
        found = {name: np.asarray(p) for name, p in given.items() if p is not None}
        axes = result.grid.axes
        return {
            name: (axes[: p.ndim], p, labels(START[name])) for name, p in found.items()
        }

    def read(self, source: Source) -> dict[str, Any]:
        dataset, found = source.dataset, dict.fromkeys(START)
        axes = source.fields["grid"].axes
        for name in START:
            if name in dataset:
                if dataset[name].dims not in (axes, axes[:2]):
                    raise ValueError(
                        f"`{name}` must lie on `grid`, got other dimensions"
                    )
                check_dimensions(dataset, name, tuple(map(str, dataset[name].dims)))
                found[name] = dataset[name].values
        p0, reference = found.values()
        # Of one that was put together by hand it is not known.
        known = "call" in source.about
        if p0 is None and known and saves_start(dataset["s"], dataset["s_step"]):
            p0 = dataset["density"].values[0]
        return {"initial_density": p0, "reference": reference}


def is_saved(solution: Any) -> bool:
    """Whether the first saved density is what the run began with."""
    p0 = solution.initial_density
    at_start = p0 is not None and saves_start(solution.saved_s, solution.series["s"])
    return at_start and np.array_equal(solution.densities[0], p0)


def saves_start(saved_s: Any, s: Any) -> bool:
    """Whether the first saved density is the one at the start."""
    return bool(saved_s.size and s.size and saved_s[0] == s[0])


def checked_description(scheme: dict[str, Any]) -> dict[str, Any]:
    """What describes a scheme; ValueError if it does not."""
    if "name" not in scheme:
        raise ValueError(
            f"`scheme` must name and describe a scheme, got {shown(scheme)}"
        )
    return scheme


SOLUTION = Layout(
    "Solution of the fibre lay-down Fokker-Planck equation",
    Attribute("Conventions", values=lambda _: "CF-1.11"),
    Model(),
    SAVED,
    OnGrid(grid_from_dict, DENSITY),
    Variable("entropy_floor", (), "value that H(p|p_S) tends to on this grid",
             kind=float),
    _Start(),
    Recorded("step"),
    Attribute("scheme", write_as=to_json, read_as=checked_description),
    STEP,
    STATUS,
    Attribute("message"),
)  # fmt: skip
