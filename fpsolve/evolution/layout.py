"""Whether the parts of a stored result fit each other."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.checks import shown
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.plane import PlaneGrid

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "check_counts",
    "check_dimensions",
    "check_increasing",
    "check_plane_layout",
    "check_run",
    "check_solution_layout",
    "check_status",
    "check_step",
]

_AXES = ("xi1", "xi2", "alpha")
_STATUS = ("finished", "interrupted", "failed")
# Cell centres are stored as they were computed; a later version may round otherwise.
_SAME = 1e-9


def check_solution_layout(
    dataset: xr.Dataset, grid: PhaseSpaceGrid, attributes: Mapping[str, Any]
) -> None:
    """Raise ValueError unless densities, axes, series and attributes fit the grid."""
    _check_on_grid(dataset, grid, _AXES)
    check_dimensions(dataset, {"s": ("s",), "s_step": ("step",), "entropy_floor": ()})
    _check_errors(dataset, ("s", "step"))
    for name in ("initial_density", "reference_density"):
        if name in dataset and dataset[name].dims not in (_AXES, _AXES[:2]):
            raise ValueError(f"`{name}` must lie on `grid`, got other dimensions")
    check_run(dataset, attributes)
    scheme = attributes["scheme"]
    if "name" not in scheme:
        raise ValueError(
            f"`scheme` must name and describe a scheme, got {shown(scheme)}"
        )


def check_plane_layout(
    dataset: xr.Dataset, grid: PlaneGrid, attributes: Mapping[str, Any]
) -> None:
    """Raise ValueError unless plane densities, axes and series fit the grid."""
    _check_on_grid(dataset, grid, _AXES[:2])
    check_dimensions(dataset, {"s": ("s",), "s_step": ("s_step",)})
    if "initial_density" in dataset:
        check_dimensions(dataset, {"initial_density": _AXES[:2]})
    _check_errors(dataset, ("s", "s_step"))
    check_run(dataset, attributes)


def check_run(dataset: xr.Dataset, attributes: Mapping[str, Any]) -> None:
    """Raise ValueError unless arclengths increase, and step and status are ones."""
    for name in ("s", "s_step"):
        check_increasing(name, dataset[name].values)
    check_step(attributes["ds"])
    check_status(attributes["status"])


def check_status(status: str) -> None:
    """Raise ValueError unless it is how a run can end."""
    if status not in _STATUS:
        raise ValueError(
            f"`status` must be one of {', '.join(map(repr, _STATUS))}, got {status!r}"
        )


def check_dimensions(
    dataset: xr.Dataset, expected: Mapping[str, tuple[str, ...]]
) -> None:
    """Raise ValueError unless variables hold numbers over these dimensions."""
    for name, dims in expected.items():
        found = dataset[name]
        if found.dims != dims or found.dtype.kind not in "iuf":
            raise ValueError(
                f"`{name}` must hold numbers over {', '.join(dims) or 'nothing'}, got "
                f"{found.dtype} over {', '.join(map(str, found.dims)) or 'nothing'}"
            )


def check_counts(name: str, expected: Any, got: Any, of: str) -> None:
    """Raise ValueError unless what an attribute says is what a variable holds."""
    if expected != got:
        raise ValueError(
            f"`{name}` must be {shown(got)} as in {of}, got {shown(expected)}"
        )


def _check_on_grid(
    dataset: xr.Dataset, grid: PhaseSpaceGrid | PlaneGrid, axes: tuple[str, ...]
) -> None:
    density = dataset["density"]
    expected = (dataset.sizes["s"], *grid.shape)
    if density.dims != ("s", *axes) or density.shape != expected:
        raise ValueError(
            f"`density` must have the shape {expected} of `s` and `grid`, got "
            f"{density.shape} over {', '.join(map(str, density.dims))}"
        )
    for name in axes:
        if not np.allclose(dataset[name], getattr(grid, name), rtol=_SAME, atol=_SAME):
            raise ValueError(f"`{name}` must be the cell centres of `grid`, got others")


def _check_errors(dataset: xr.Dataset, over: tuple[str, ...]) -> None:
    for name, variable in dataset.data_vars.items():
        if variable.dims == over[1:] or str(name).endswith("_error"):
            check_dimensions(dataset, {str(name): tuple(map(str, variable.dims))})
        if str(name).endswith("_error") and variable.dims not in {(n,) for n in over}:
            raise ValueError(
                f"`{name}` must be a series over {' or '.join(over)}, got one over "
                f"{', '.join(map(str, variable.dims)) or 'nothing'}"
            )


def check_increasing(name: str, values: NDArray[np.float64]) -> None:
    """Raise ValueError unless the arclengths are finite and increase."""
    if not (np.isfinite(values).all() and (np.diff(values) > 0).all()):
        raise ValueError(f"`{name}` must be finite and increase, got other numbers")


def check_step(ds: Any) -> None:
    """Raise ValueError unless the step is positive."""
    if not 0 < float(ds) < math.inf:
        raise ValueError(f"`ds` must be positive, got {float(ds):g}")
