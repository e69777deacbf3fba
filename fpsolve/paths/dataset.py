"""Paths as a labelled `xarray.Dataset`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.labels import labels, origin, to_json
from fpsolve.evolution.saved import described_as
from fpsolve.evolution.series import SERIES
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.stored import describe_model
from fpsolve.paths.law_dataset import describe_law, law_variables

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["PARTS", "to_xarray"]

Array = NDArray[np.float64]

_TITLE = "Paths of the stochastic fibre lay-down process"
_AXES = ("xi1", "xi2", "alpha")
_CELLS = tuple(f"cell_{axis}" for axis in _AXES)
# The parts of a state: name, its place in the array of states, long name.
PARTS = (
    ("xi", slice(0, 2), "deviation ξ"),
    ("tau", slice(2, 4), "tangent τ = (cos α, sin α)"),
    ("turns", 4, "full turns of the angle α"),
)
_MEAN_SQUARE = "mean E ‖ξ‖²"


def to_xarray(paths: Any) -> xr.Dataset:
    """ξ(s) and α(s) of every path, moments and histograms as one labelled dataset.

    Dimensions: `s` (saved arclengths), `path`, `component` (1 along the belt, 2
    across), and for histograms `cell_xi1`, `cell_xi2` and `cell_alpha`. Of paths that
    were not kept there are moments and histograms only. The attributes and the
    variables that begin with `start_`, `end_` and `initial_` hold what is needed to
    repeat the paths and to go on with them.

    Parameters
    ----------
    paths : Paths

    Returns
    -------
    xarray.Dataset
    """
    import xarray as xr

    variables = {
        **(_positions(paths) if paths.kept else {}),
        **_moments(paths),
        **(_counts(paths) if paths.ensemble.grid is not None else {}),
        **law_variables(paths.initial),
    }
    dataset = xr.Dataset(variables, _coordinates(paths), _attributes(paths))
    return described_as(dataset, paths)


def _positions(paths: Any) -> dict[str, Any]:
    """Return all states, and the angles, which readers of the file need the most."""
    return {
        **_state_variables("", ("s",), paths.states, ""),
        "alpha": (
            ("s", "path"),
            paths.alpha,
            labels("angle α in radians, continuous along a path"),
        ),
        **_state_variables("start_", (), paths.start, " at the start"),
        **_state_variables("end_", (), paths.end, " at the end"),
    }


def _state_variables(
    prefix: str, dimensions: tuple[str, ...], states: Array, when: str
) -> dict[str, Any]:
    variables = {}
    for name, place, long_name in PARTS:
        values, own = states[..., place, :], (*dimensions, "path")
        if isinstance(place, slice):
            values, own = np.swapaxes(values, -1, -2), (*own, "component")
        variables[prefix + name] = (own, values, labels(long_name + when))
    return variables


def _moments(paths: Any) -> dict[str, Any]:
    moments = paths.moments()
    variables: dict[str, Any] = {
        "moment_sums": (
            ("s", "sum"),
            paths.sums,
            labels("sums over paths from which the moments come"),
        )
    }
    for name, values in moments.values.items():
        known = SERIES.get(name)
        long_name = known.words if known else _MEAN_SQUARE
        error = f"{name}_standard_error"
        variables[name] = ("s", values, labels(long_name))
        variables[error] = (
            "s",
            moments.standard_errors[name],
            labels(f"standard error of: {long_name}"),
        )
    return variables


def _counts(paths: Any) -> dict[str, Any]:
    return {
        "counts": (("s", *_CELLS), paths.counts, labels("number of paths in a cell")),
        "outside": (
            "s",
            paths.outside,
            labels("number of paths outside of the box of cells"),
        ),
    }


def _coordinates(paths: Any) -> dict[str, Any]:
    coordinates: dict[str, Any] = {
        "s": ("s", paths.s, labels("arclength s of the saved points"))
    }
    if paths.kept:
        n_paths, components = np.arange(paths.n_paths), np.array([1, 2])
        coordinates["path"] = ("path", n_paths, labels("number of the path"))
        coordinates["component"] = (
            "component",
            components,
            labels("component, 1 along the belt and 2 across"),
        )
    grid = paths.ensemble.grid
    if grid is not None:
        for axis, cell in zip(_AXES, _CELLS, strict=True):
            centres = labels(f"centre of the cell in {axis}")
            coordinates[cell] = (cell, getattr(grid, axis), centres)
    return coordinates


def _attributes(paths: Any) -> dict[str, Any]:
    ensemble, provenance = paths.ensemble, dict(paths.provenance)
    schedule, grid = ensemble.schedule, ensemble.grid
    # Files may come without a model.
    model: LayDownModel | None = ensemble.model
    equation = None if model is None else model.process_equation
    return {
        "Conventions": "CF-1.11",
        "title": _TITLE,
        **describe_model(model, equation, provenance),
        "initial": to_json(describe_law(ensemble.law, provenance)),
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
        "status": paths.status,
        "message": paths.message,
        **origin(provenance),
    }
