"""Paths from the labelled `xarray.Dataset` that describes them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.declared import declared
from fpsolve._support.labels import check_complete
from fpsolve.evolution.call import Call
from fpsolve.evolution.layout import (
    check_counts,
    check_dimensions,
    check_increasing,
    check_status,
    check_step,
)
from fpsolve.evolution.schedule import Schedule
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.stored import read_model
from fpsolve.paths.dataset import PARTS
from fpsolve.paths.ensemble import Ensemble
from fpsolve.paths.law_dataset import read_law
from fpsolve.paths.result import Paths

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["from_xarray"]

Array = NDArray[np.float64]

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
        call=Call.from_xarray(dataset),
    )


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
    names = [prefix + name for name, _, _ in PARTS]
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
