"""Paths as a labelled `xarray.Dataset`, and back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.declared import declared
from fpsolve._support.labels import (
    check_complete,
    describe_model,
    labels,
    origin,
    read_model,
    to_json,
)
from fpsolve.density.layout import (
    check_counts,
    check_dimensions,
    check_increasing,
    check_status,
    check_step,
)
from fpsolve.evolution.schedule import Schedule
from fpsolve.evolution.series import SERIES
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel
from fpsolve.paths import Paths
from fpsolve.paths.ensemble import Ensemble
from fpsolve.paths.law_dataset import describe_law, law_variables, read_law

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["from_xarray", "process_equation", "to_xarray"]

Array = NDArray[np.float64]

_TITLE = "Paths of the stochastic fibre lay-down process"
_NEEDED = ("s", "moment_sums")
_NEEDED_ATTRIBUTES = (
    "model",
    "initial",
    "n_paths",
    "seed",
    "method",
    "ds",
    "s_start",
    "n_steps",
    "saved_steps",
    "kept",
    "status",
    "message",
    "provenance",
)
_AXES = ("xi1", "xi2", "alpha")
_CELLS = tuple(f"cell_{axis}" for axis in _AXES)
# The parts of a state: name, its place in the array of states, long name.
_PARTS = (
    ("xi", slice(0, 2), "deviation ξ"),
    ("tau", slice(2, 4), "tangent τ = (cos α, sin α)"),
    ("turns", 4, "full turns of the angle α"),
)
_LONG_NAMES = {**SERIES, "mean_square": "mean E ‖ξ‖²"}


def to_xarray(paths: Paths) -> xr.Dataset:
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
    return xr.Dataset(variables, _coordinates(paths), _attributes(paths))


def from_xarray(dataset: xr.Dataset) -> Paths:
    """Return the paths that `to_xarray` turned into `dataset`, bit for bit.

    A model or a law of the start made of a user's own code cannot be read back; it is
    None then, with a warning.

    Parameters
    ----------
    dataset : xarray.Dataset

    Raises
    ------
    ValueError
        If the dataset does not have the layout of `to_xarray`.

    Warns
    -----
    UserWarning
        If the model or the law of the start could not be read back.
    """
    check_complete(dataset, _NEEDED, _NEEDED_ATTRIBUTES)
    attributes = declared(dataset.attrs)
    provenance = attributes["provenance"]
    ensemble = _read_ensemble(dataset, attributes, provenance)
    counts, outside = _read_counts(dataset, ensemble.grid)
    return Paths(
        ensemble=ensemble,
        s=dataset["s"].values,
        states=_read_states(dataset, "", ensemble.keep),
        sums=dataset["moment_sums"].values,
        counts=counts,
        outside=outside,
        start=_read_states(dataset, "start_", ensemble.keep),
        end=_read_states(dataset, "end_", ensemble.keep),
        status=attributes["status"],
        message=attributes["message"],
        provenance=provenance,
    )


def process_equation(model: LayDownModel) -> str:
    """Return the stochastic equation (6) as plain text with the actual parameters."""
    curve = model.curve
    motion = "τ(α) ds - dγ"
    if curve.fixed:
        motion = "τ(α) ds"
    elif curve.autonomous:
        sign = "-" if curve.speed < 0 else "+"
        motion = f"(τ(α) {sign} {abs(curve.speed):g} e₁) ds"
    noise = f" + {model.noise:g} dW" if model.noise else ""
    terms = [
        f"dξ = {motion}",
        f"dα = -∇B(ξ)·τ⊥(α) ds{noise}",
        f"B = {model.potential.formula}",
    ]
    if not curve.autonomous:
        terms.append(f"γ(s) = {curve.formula}")
    return ", ".join(terms)


def _positions(paths: Paths) -> dict[str, Any]:
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
    for name, place, long_name in _PARTS:
        values, own = states[..., place, :], (*dimensions, "path")
        if isinstance(place, slice):
            values, own = np.swapaxes(values, -1, -2), (*own, "component")
        variables[prefix + name] = (own, values, labels(long_name + when))
    return variables


def _moments(paths: Paths) -> dict[str, Any]:
    moments = paths.moments()
    variables: dict[str, Any] = {
        "moment_sums": (
            ("s", "sum"),
            paths.sums,
            labels("sums over paths from which the moments come"),
        )
    }
    for name, values in moments.values.items():
        long_name = _LONG_NAMES[name]
        error = f"{name}_standard_error"
        variables[name] = ("s", values, labels(long_name))
        variables[error] = (
            "s",
            moments.standard_errors[name],
            labels(f"standard error of: {long_name}"),
        )
    return variables


def _counts(paths: Paths) -> dict[str, Any]:
    return {
        "counts": (("s", *_CELLS), paths.counts, labels("number of paths in a cell")),
        "outside": (
            "s",
            paths.outside,
            labels("number of paths outside of the box of cells"),
        ),
    }


def _coordinates(paths: Paths) -> dict[str, Any]:
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


def _attributes(paths: Paths) -> dict[str, Any]:
    ensemble, provenance = paths.ensemble, dict(paths.provenance)
    schedule, grid = ensemble.schedule, ensemble.grid
    # Files may come without a model.
    model: LayDownModel | None = ensemble.model
    equation = None if model is None else process_equation(model)
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


def _read_ensemble(
    dataset: xr.Dataset, attributes: Mapping[str, Any], provenance: dict[str, Any]
) -> Ensemble:
    _check_layout(dataset, attributes)
    law = attributes["initial"]
    model: Any = read_model(attributes, provenance)
    return Ensemble(
        model=model,
        n_paths=attributes["n_paths"],
        schedule=_read_schedule(attributes),
        seed=int(attributes["seed"]),
        method=attributes["method"],
        law=read_law(law, dataset, provenance),
        keep=bool(attributes["kept"]),
        grid=(
            PhaseSpaceGrid.from_dict(attributes["grid"])
            if "grid" in attributes
            else None
        ),
    )


def _read_schedule(attributes: Mapping[str, Any]) -> Schedule:
    return Schedule(
        start=float(attributes["s_start"]),
        ds=float(attributes["ds"]),
        n_steps=attributes["n_steps"],
        records=(),
        saves=tuple(attributes["saved_steps"]),
    )


def _check_layout(dataset: xr.Dataset, attributes: Mapping[str, Any]) -> None:
    """Raise ValueError unless numbers of paths and steps are those of the arrays."""
    check_dimensions(dataset, {"s": ("s",), "moment_sums": ("s", "sum")})
    check_increasing("s", dataset["s"].values)
    check_step(attributes["ds"])
    check_status(attributes["status"])
    n_saved, places = dataset.sizes["s"], attributes["saved_steps"]
    if len(places) != n_saved:
        raise ValueError(
            f"`saved_steps` must be {n_saved} steps as in `s`, got {len(places)}"
        )
    if any(step > attributes["n_steps"] for step in places):
        raise ValueError(
            f"`n_steps` must be the last step, got {attributes['n_steps']} before "
            f"{max(places)}"
        )
    if attributes["kept"]:
        check_complete(dataset, ("xi", "tau", "turns"), ())
        check_dimensions(dataset, {"xi": ("s", "path", "component")})
        check_counts("n_paths", attributes["n_paths"], dataset.sizes["path"], "`xi`")


def _read_states(dataset: xr.Dataset, prefix: str, kept: bool) -> Array:
    names = [prefix + name for name, _, _ in _PARTS]
    if not kept:
        n_saved = () if prefix else (dataset.sizes["s"],)
        return np.empty((*n_saved, 5, 0))
    check_complete(dataset, names, ())
    xi, tau, turns = (dataset[name].values for name in names)
    states = np.empty((*turns.shape[:-1], 5, turns.shape[-1]))
    states[..., 0:2, :] = np.swapaxes(xi, -1, -2)
    states[..., 2:4, :] = np.swapaxes(tau, -1, -2)
    states[..., 4, :] = turns
    return states


def _read_counts(
    dataset: xr.Dataset, grid: PhaseSpaceGrid | None
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    if grid is None:
        return np.empty((0, 0, 0, 0), np.int64), np.empty(0, np.int64)
    check_complete(dataset, ("counts", "outside"), ())
    check_counts("grid", grid.shape, dataset["counts"].shape[1:], "`counts`")
    return dataset["counts"].values, dataset["outside"].values
