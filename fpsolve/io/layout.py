"""Whether the parts of a stored result fit each other."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._checks import shown
from fpsolve.grids import PhaseSpaceGrid

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["check_solution_layout", "check_step"]

_AXES = ("xi1", "xi2", "alpha")
_STATUS = ("finished", "interrupted", "failed")
# Cell centres are stored as they were computed; a later version may round otherwise.
_SAME = 1e-9


def check_solution_layout(
    dataset: xr.Dataset, grid: PhaseSpaceGrid, scheme: Any
) -> None:
    """Raise ValueError unless densities, axes, series and attributes fit the grid."""
    density = dataset["density"]
    expected = (dataset.sizes["s"], *grid.shape)
    if density.dims != ("s", *_AXES) or density.shape != expected:
        raise ValueError(
            f"`density` must have the shape {expected} of `s` and `grid`, got "
            f"{density.shape} over {', '.join(map(str, density.dims))}"
        )
    for name in _AXES:
        if not np.allclose(dataset[name], getattr(grid, name), rtol=_SAME, atol=_SAME):
            raise ValueError(f"`{name}` must be the cell centres of `grid`, got others")
    for name in ("s", "s_step"):
        check_increasing(name, dataset[name].values)
    check_step(dataset.attrs["ds"])
    status = str(dataset.attrs["status"])
    if status not in _STATUS:
        raise ValueError(
            f"`status` must be one of {', '.join(map(repr, _STATUS))}, got {status!r}"
        )
    if not isinstance(scheme, dict) or "name" not in scheme:
        raise ValueError(
            f"`scheme` must name and describe a scheme, got {shown(scheme)}"
        )


def check_increasing(name: str, values: NDArray[np.float64]) -> None:
    """Raise ValueError unless the arclengths are finite and increase."""
    if not (np.isfinite(values).all() and (np.diff(values) > 0).all()):
        raise ValueError(f"`{name}` must be finite and increase, got other numbers")


def check_step(ds: Any) -> None:
    """Raise ValueError unless the step is positive."""
    if not 0 < float(ds) < math.inf:
        raise ValueError(f"`ds` must be positive, got {float(ds):g}")
