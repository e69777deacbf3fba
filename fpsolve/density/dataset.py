"""A solution as a labelled `xarray.Dataset`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np

from fpsolve._support.labels import labels, origin, to_json
from fpsolve._support.streaming import Streamed
from fpsolve.evolution.saved import described_as
from fpsolve.evolution.series import (
    COORDINATES,
    DENSITY,
    START,
    long_name,
)
from fpsolve.evolution.stored import LazyDensities
from fpsolve.model.stored import describe_model

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["saves_start", "stored_parts", "to_xarray"]

_TITLE = "Solution of the fibre lay-down Fokker-Planck equation"
_AXES = ("xi1", "xi2", "alpha")


def to_xarray(solution: Any, densities: Any = None) -> xr.Dataset:
    """p(s, ξ1, ξ2, α) and every series as one labelled dataset.

    The densities share memory with the solution. Dimensions: `s` (saved densities),
    `xi1`, `xi2`, `alpha`, and `step` (recorded steps, with the coordinate `s_step`).
    Error estimates, when there are any, are variables that end in `_error`. The
    attributes hold equation, model, grid and scheme (as JSON), `ds`, status, versions
    and date; `call` holds the arguments of the run. `initial_density` is there
    unless it is among the saved densities, `reference_density` if one was given: with
    them the run can be repeated.

    Parameters
    ----------
    solution : Solution
    densities : array_like, optional
        Stands in for the densities.

    Returns
    -------
    xarray.Dataset
    """
    import xarray as xr

    if densities is None:
        densities = np.asarray(solution.densities)
    variables: dict[str, Any] = {
        "density": (("s", *_AXES), densities, labels(DENSITY)),
        "entropy_floor": (
            (),
            solution.entropy_floor,
            labels("value that H(p|p_S) tends to on this grid"),
        ),
    }
    for name, start in _start(solution).items():
        variables[name] = (_AXES[: start.ndim], start, labels(START[name]))
    for name, values in solution.series.items():
        if name != "s":
            variables[name] = ("step", values, labels(long_name(name)))
    for name, values in (solution.errors or {}).items():
        dimension = "step" if name in solution.series else "s"
        error = f"{name}_error"
        variables[error] = (dimension, values, labels(long_name(error)))
    dataset = xr.Dataset(variables, _coordinates(solution), _attributes(solution))
    return described_as(dataset, solution)


def stored_parts(solution: Any) -> tuple[xr.Dataset, Streamed | None]:
    """The dataset of a solution, and apart from it densities that are on the disk."""
    densities = cast(Any, solution.densities)
    if not isinstance(densities, LazyDensities):
        return to_xarray(solution), None
    # One number in the place of all, which takes no memory.
    nothing = np.broadcast_to(np.float64(0.0), densities.shape)
    rest = to_xarray(solution, nothing).drop_vars("density")
    shape, kind = densities.shape, densities.dtype
    about = ("s", *_AXES), shape, kind, densities, labels(DENSITY)
    return rest, Streamed("density", *about)


def _start(solution: Any) -> dict[str, Any]:
    """Return what the run began with, unless it is among the saved densities."""
    p0, found = solution.initial_density, {}
    if p0 is not None and not _is_saved(p0, solution):
        found["initial_density"] = p0
    if solution.reference is not None:
        found["reference_density"] = np.asarray(solution.reference)
    return found


def _is_saved(p0: Any, solution: Any) -> bool:
    saved = saves_start(solution.saved_s, solution.series["s"])
    return saved and np.array_equal(solution.densities[0], p0)


def saves_start(saved_s: Any, s: Any) -> bool:
    """Whether the first saved density is the one at the start."""
    return bool(saved_s.size and s.size and saved_s[0] == s[0])


def _coordinates(solution: Any) -> dict[str, Any]:
    values = {
        "s": ("s", solution.saved_s),
        "s_step": ("step", solution.series["s"]),
        **{name: (name, getattr(solution.grid, name)) for name in _AXES},
    }
    return {
        name: (dimension, array, labels(COORDINATES[name]))
        for name, (dimension, array) in values.items()
    }


def _attributes(solution: Any) -> dict[str, Any]:
    model = solution.model
    equation = None if model is None else model.equation
    return {
        "Conventions": "CF-1.11",
        "title": _TITLE,
        **describe_model(model, equation, solution.provenance),
        "grid": to_json(solution.grid.to_dict()),
        "scheme": to_json(solution.scheme),
        "ds": solution.ds,
        "status": solution.status,
        "message": solution.message,
        **origin(solution.provenance),
    }
