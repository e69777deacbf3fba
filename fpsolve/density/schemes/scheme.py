"""What a run needs of a scheme, and of the density that it begins with."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import shown
from fpsolve.density.schemes.form import State
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel

__all__ = ["Scheme", "checked_scheme", "checked_start"]


class Scheme(Protocol):
    """What `solve` needs of a scheme; see docs/extending.md."""

    name: str
    order: int
    model: LayDownModel
    grid: PhaseSpaceGrid
    correction_limit: float

    @property
    def options(self) -> dict[str, Any]: ...  # noqa: D102
    @property
    def n_arrays(self) -> float: ...  # noqa: D102
    def start(self, p0: Array) -> State: ...  # noqa: D102
    def density(self, state: State) -> Array: ...  # noqa: D102
    def advance(self, state: State, s: float, ds: float, n_steps: int = 1) -> None: ...  # noqa: D102


def checked_scheme(scheme: Any, name: str = "scheme") -> Scheme:
    """The scheme; TypeError unless it has what `solve` needs."""
    needed = ("model", "grid", "start", "density", "advance")
    if isinstance(scheme, type) or not all(hasattr(scheme, name) for name in needed):
        raise TypeError(
            f"`{name}` must be a scheme, got {shown(scheme)}; make one by "
            "drift_kick(model, grid)."
        )
    made: Scheme = scheme
    return made


def checked_start(scheme: Scheme, p0: Array) -> Array:
    """The initial density if it fits the scheme's grid and is finite with mass."""
    p0 = scheme.grid.check(p0, "p0")
    if not np.isfinite(p0).all():
        index = tuple(int(i) for i in np.argwhere(~np.isfinite(p0))[0])
        raise ValueError(f"`p0` must be finite, got {p0[index]:g} at index {index}.")
    if not p0.sum() > 0:
        raise ValueError(f"`p0` must have positive mass, got {p0.sum():g}.")
    return p0
