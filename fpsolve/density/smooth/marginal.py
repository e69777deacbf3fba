"""A result of a smooth fibre as one of position and angle alone."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from fpsolve.density.solution import Solution
from fpsolve.grids import diagnostics
from fpsolve.grids.smooth import SmoothPhaseSpaceGrid

__all__ = ["without_curvature"]


def without_curvature(result: Any) -> Any:
    """The marginal of (ξ, α) of a `Solution` or a `SteadyState`, with its errors.

    Those of the density bound what they are of the marginal. One without a curvature
    is returned as it is.
    """
    grid = result.grid
    if not isinstance(grid, SmoothPhaseSpaceGrid):
        return result

    def marginal(p: Any) -> Any:
        return diagnostics.marginal(p, grid, "xi_alpha")

    if not isinstance(result, Solution):
        errors = {
            name: error
            for name, error in result.moment_errors.items()
            if "kappa" not in name
        }
        density = marginal(result.density)
        return replace(
            result, grid=grid.phase_space, density=density, moment_errors=errors
        )
    densities = np.empty((len(result.saved_s), *grid.shape[:3]))
    for place in range(len(result.saved_s)):
        densities[place] = marginal(result.densities[place])
    return replace(
        result, grid=grid.phase_space, densities=densities, initial_density=None,
        reference=None,
    )  # fmt: skip
