"""How paths are stored: positions, moments, histograms, and what determines them.

Of paths that were not kept there are moments and histograms only. What begins with
`start_`, `end_` and `initial_` is needed to repeat the paths and to go on with them.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.labels import check_complete, labels, to_json
from fpsolve.evolution.layout import (
    Attribute,
    Layout,
    Part,
    Source,
    Stored,
    Variable,
    check_counts,
    check_dimensions,
)
from fpsolve.evolution.parts import STATUS, Model, checked_step
from fpsolve.evolution.schedule import Schedule
from fpsolve.evolution.series import SERIES
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.paths.ensemble import KAPPA, Ensemble
from fpsolve.paths.law_dataset import Law
from fpsolve.paths.moments import n_sums

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["PATHS"]


_CELLS = tuple(f"cell_{axis}" for axis in PhaseSpaceGrid.axes)
# The parts of a state: name, its place in the array of states, long name.
STATE = (
    ("xi", slice(0, 2), "deviation ξ"),
    ("tau", slice(2, 4), "tangent τ = (cos α, sin α)"),
    ("turns", 4, "full turns of the angle α"),
    ("kappa", KAPPA, "curvature κ"),
)
# Moments that no solution has.
_MOMENTS = {
    "mean_square": "mean E ‖ξ‖²",
    "mean_kappa": "mean E κ",
    "mean_kappa2": "mean square E κ²",
}
# States of a result: field, what begins the names of variables, dimensions, when.
STATES: Any = (
    ("states", "", ("s",), ""),
    ("start", "start_", (), " at the start"),
    ("end", "end_", (), " at the end"),
)


class _Determined(Part):
    """What determines the paths; a model and a law of the start have their own parts.

    Numbers of paths and steps must be those of the arrays.
    """

    needed = ("n_paths", "seed", "method", "ds", "s_start", "n_steps",
              "saved_steps", "kept")  # fmt: skip

    def write(self, result: Any) -> Stored:
        ensemble = result.ensemble
        schedule, grid = ensemble.schedule, ensemble.grid
        return {
            "n_paths": ensemble.n_paths,
            # As text, because a seed may be longer than any integer of a file.
            "seed": str(ensemble.seed),
            "method": ensemble.method,
            "ds": schedule.ds,
            "s_start": schedule.start,
            "n_steps": schedule.n_steps,
            "saved_steps": to_json(schedule.saves),
            "kept": int(ensemble.keep),
            **({} if grid is None else {"grid": to_json(grid.to_dict())}),
        }

    def read(self, source: Source) -> dict[str, Any]:
        about = source.about
        check_steps(source.dataset, about)
        schedule = Schedule(
            start=float(about["s_start"]),
            ds=checked_step(about["ds"]),
            n_steps=about["n_steps"],
            records=(),
            saves=tuple(about["saved_steps"]),
        )
        grid = PhaseSpaceGrid.from_dict(about["grid"]) if "grid" in about else None
        ensemble = Ensemble(
            model=source.fields.pop("model"),
            n_paths=about["n_paths"],
            schedule=schedule,
            seed=int(about["seed"]),
            method=about["method"],
            law=source.fields.pop("initial"),
            keep=bool(about["kept"]),
            grid=grid,
        )
        return {"ensemble": ensemble}


def check_steps(dataset: xr.Dataset, about: Mapping[str, Any]) -> None:
    """Raise ValueError unless as many steps are saved, and not beyond the last."""
    n_saved, places = dataset.sizes["s"], about["saved_steps"]
    if len(places) != n_saved:
        raise ValueError(
            f"`saved_steps` must be {n_saved} steps as in `s`, got {len(places)}"
        )
    if any(step > about["n_steps"] for step in places):
        raise ValueError(
            f"`n_steps` must be the last step, got {about['n_steps']} before "
            f"{max(places)}"
        )


class _Positions(Part):
    """All states, and the angles, which readers of the file need the most."""

    def write(self, result: Any) -> Stored:
        if not result.kept:
            return {}
        words = "angle α in radians, continuous along a path"
        here, start, end = (
            _variables(getattr(result, name), *how) for name, *how in STATES
        )
        angles = {"alpha": (("s", "path"), result.alpha, labels(words))}
        words = "component, 1 along the belt and 2 across"
        return {
            **here, **angles, **start, **end,
            "path": ("path", np.arange(result.n_paths), labels("number of the path")),
            "component": ("component", np.array([1, 2]), labels(words)),
        }  # fmt: skip

    def read(self, source: Source) -> dict[str, Any]:
        dataset, ensemble = source.dataset, source.fields["ensemble"]
        n_state = _n_state(source)
        if not ensemble.keep:
            n_saved = dataset.sizes["s"]
            nothing = np.empty((n_state, 0))
            return {"states": np.empty((n_saved, n_state, 0)), "start": nothing,
                    "end": nothing}  # fmt: skip
        parts = [name for name, *_ in state_parts(n_state)]
        names = [prefix + name for _, prefix, *_ in STATES for name in parts]
        check_complete(dataset, *names)
        check_dimensions(dataset, "xi", ("s", "path", "component"))
        check_counts("n_paths", ensemble.n_paths, dataset.sizes["path"], "`xi`")
        return {name: _states(dataset, prefix, n_state) for name, prefix, *_ in STATES}


def state_parts(n_state: int) -> list[tuple[str, Any, str]]:
    """The parts of states of so many numbers."""
    return [part for part in STATE if part[1] != KAPPA or n_state > KAPPA]


def _n_state(source: Source) -> int:
    """Numbers of a state, from those of which there are sums; they fit the model."""
    n_found, ensemble = source.fields["sums"].shape[1], source.fields["ensemble"]
    if ensemble.model is None:
        return KAPPA + 1 if n_found == n_sums(KAPPA + 1) else KAPPA
    n_state: int = ensemble.n_state
    check_counts("moment_sums", n_found, n_sums(n_state), "`model`")
    return n_state


def _variables(
    states: Array, prefix: str, dimensions: tuple[str, ...], when: str
) -> Stored:
    variables: Stored = {}
    for name, place, words in state_parts(states.shape[-2]):
        values, over = states[..., place, :], (*dimensions, "path")
        if isinstance(place, slice):
            values, over = np.swapaxes(values, -1, -2), (*over, "component")
        variables[prefix + name] = (over, values, labels(words + when))
    return variables


def _states(dataset: xr.Dataset, prefix: str, n_state: int) -> Array:
    turns = dataset[f"{prefix}turns"].values
    states = np.empty((*turns.shape[:-1], n_state, turns.shape[-1]))
    for name, place, _ in state_parts(n_state):
        values = dataset[prefix + name].values
        vector = isinstance(place, slice)
        states[..., place, :] = np.swapaxes(values, -1, -2) if vector else values
    return states


class _Estimates(Part):
    """Moments with their standard errors, for the readers of the dataset."""

    def write(self, result: Any) -> Stored:
        moments, variables = result.moments(), {}
        for name, values in moments.values.items():
            words = SERIES[name].words if name in SERIES else _MOMENTS[name]
            error = moments.standard_errors[name]
            variables[name] = ("s", values, labels(words))
            variables[f"{name}_standard_error"] = (
                "s", error, labels(f"standard error of: {words}"),
            )  # fmt: skip
        return variables


class _Counts(Part):
    """Histograms, if there are any."""

    def write(self, result: Any) -> Stored:
        grid = result.ensemble.grid
        if grid is None:
            return {}
        outside = "number of paths outside of the box of cells"
        centres = {
            cell: (cell, getattr(grid, axis), labels(f"centre of the cell in {axis}"))
            for axis, cell in zip(grid.axes, _CELLS, strict=True)
        }
        return {
            **centres,
            "counts": (("s", *_CELLS), result.counts,
                       labels("number of paths in a cell")),
            "outside": ("s", result.outside, labels(outside)),
        }  # fmt: skip

    def read(self, source: Source) -> dict[str, Any]:
        dataset, grid = source.dataset, source.fields["ensemble"].grid
        if grid is None:
            none = np.empty((0, 0, 0, 0), np.int64)
            return {"counts": none, "outside": np.empty(0, np.int64)}
        check_complete(dataset, "counts", "outside")
        check_counts("grid", grid.shape, dataset["counts"].shape[1:], "`counts`")
        return {name: dataset[name].values for name in ("counts", "outside")}


PATHS = Layout(
    "Paths of the stochastic fibre lay-down process",
    Attribute("Conventions", values=lambda _: "CF-1.11"),
    Model(equation="process_equation"),
    Variable("s", ("s",), "arclength s of the saved points", increasing=True),
    Variable("moment_sums", ("s", "sum"),
             "sums over paths from which the moments come", "sums"),
    Law(),
    _Determined(),
    _Positions(),
    _Estimates(),
    _Counts(),
    STATUS,
    Attribute("message"),
)  # fmt: skip
