"""Densities of smooth fibres for studies of limits: grid, run, marginal of (ξ, α)."""

from __future__ import annotations

import math
from typing import Any

from fpsolve._support.arrays import Array
from fpsolve.density.smooth.smooth_drift_kick import SmoothDriftKick
from fpsolve.density.solve import solve
from fpsolve.grids import diagnostics, initial
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.smooth import SmoothPhaseSpaceGrid
from fpsolve.model.potentials.nodes import gibbs_nodes
from fpsolve.model.smooth import SmoothLayDownModel

__all__ = ["curved_grid", "smooth_marginal"]

# Half width of the curvature in its deviations, and cells in κ over √(A²/2R).
_DEVIATIONS, _CELL = 5.5, 0.65


def curved_grid(
    model: SmoothLayDownModel, grid: PhaseSpaceGrid
) -> SmoothPhaseSpaceGrid:
    """A grid with the curvatures of the noise and of the mean square of the force."""
    force = sum(gibbs_nodes(model.potential).mean_square_forces()) / 2
    deviation = math.sqrt(model.curvature_variance)
    half_width = _DEVIATIONS * math.hypot(deviation, math.sqrt(force))
    n_kappa = 2 * math.ceil(half_width / (_CELL * deviation))
    return SmoothPhaseSpaceGrid(grid.half_width, half_width, (*grid.shape, n_kappa))


def smooth_marginal(
    model: SmoothLayDownModel, grid: PhaseSpaceGrid, p0: Array, s: float, n_steps: int
) -> Array:
    """p(ξ, α) at s, from p0 times the Gaussian of a free curvature."""
    curved = curved_grid(model, grid)
    start = initial.with_curvature(p0, curved, model.curvature_variance)
    scheme: Any = SmoothDriftKick(model, curved)
    p = solve(
        scheme, start, (0.0, s), s / n_steps, extrapolate=True, record_every=n_steps
    ).final
    return diagnostics.marginal(p, curved, "xi_alpha")
