"""The limit 𝒫 at an arclength, and p ≈ 𝒫/2π + ε p₁, at cell centres to order four."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.special import i0e, i1e

from fpsolve._support.arrays import Array
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.plane import PlaneGrid
from fpsolve.model.fibre import FibreModel
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.paths.laws import GaussianLaw
from fpsolve.reduced.hydrodynamic.limit import HydrodynamicLimit
from fpsolve.reduced.hydrodynamic.ornstein_uhlenbeck import OrnsteinUhlenbeckLimit

__all__ = ["Approximation", "stationary_limit", "transient_limit"]

PlaneDensity = Callable[[PlaneGrid], Array]

# The centres of a cell-centred grid are among those of one three times as fine, but
# not of one twice as fine. Errors of order two fall by nine.
_FINER, _GAIN = 3, 1.0 / 8.0
# Steps of the limit equation; of order three when extrapolated, and cheap.
_STEPS = 32


@dataclass(frozen=True)
class Approximation:
    """What the limit says about p.

    Attributes
    ----------
    plane : ndarray, shape (n1, n2)
        𝒫.
    joint : ndarray, shape (n1, n2, n_alpha)
        𝒫/2π + ε p₁.
    """

    plane: Array
    joint: Array

    @property
    def uniform(self) -> Array:
        """𝒫/2π in the shape of `joint`."""
        return np.broadcast_to(self.plane[:, :, None] / math.tau, self.joint.shape)


def stationary_limit(model: FibreModel, grid: PhaseSpaceGrid) -> Approximation:
    """𝒫_S = c exp(−(B − v ξ1/ε)/F), which is known, and its p₁."""
    limit = HydrodynamicLimit(model)
    return _approximation(limit, grid, lambda plane: limit.equilibrium(*plane.mesh()))


def transient_limit(
    model: FibreModel,
    grid: PhaseSpaceGrid,
    law: GaussianLaw,
    s: float,
    *,
    corrected: bool,
) -> Approximation:
    """𝒫(s) from ρ0, or from ρ0 − 2εF∇·J if `corrected`, J = ρ0 Eτ, and its p₁.

    In closed form for quadratic B: 𝒫 of a Gaussian is one, and the displacement by
    2εF Eτ adds its derivative by the mean of the start. Otherwise by
    `HydrodynamicLimit.solve` on the cells of the grid and on others three times finer.
    """
    limit = HydrodynamicLimit(model)
    shift = 2 * limit.diffusivity * mean_direction(law) if corrected else np.zeros(2)
    if isinstance(model.potential, QuadraticPotential):
        exact = OrnsteinUhlenbeckLimit(model, law.mean, law.variance)
        return _approximation(
            limit, grid, lambda plane: _displaced(exact, plane, shift, s)
        )
    start = OrnsteinUhlenbeckLimit(_any_quadratic(), law.mean, law.variance)
    return _approximation(
        limit,
        grid,
        lambda plane: _solved(limit, plane, _displaced(start, plane, shift, 0.0), s),
    )


def mean_direction(law: GaussianLaw) -> Array:
    """Eτ = I₁(κ)/I₀(κ) (cos α0, sin α0), shape (2,)."""
    length = float(i1e(law.concentration) / i0e(law.concentration))
    angle = law.angle or 0.0
    return length * np.array([math.cos(angle), math.sin(angle)])


def _any_quadratic() -> LayDownModel:
    """At s = 0 every Ornstein-Uhlenbeck process has the Gaussian of its start."""
    return LayDownModel(QuadraticPotential(), 1.0)


def _displaced(
    exact: OrnsteinUhlenbeckLimit, plane: PlaneGrid, shift: Array, s: float
) -> Array:
    """𝒫 + shift·∂𝒫/∂m0, m0 the mean of the start."""
    density = exact.density(*plane.mesh(), s)
    if not shift.any():
        return density
    moved = np.exp(-exact.rates * s) * shift
    slope1, slope2 = np.linalg.solve(exact.covariance(s), moved)
    away = [x - m for x, m in zip(plane.mesh(), exact.mean(s), strict=True)]
    return np.asarray(density * (1 + slope1 * away[0] + slope2 * away[1]))


def _solved(
    limit: HydrodynamicLimit, plane: PlaneGrid, start: Array, s: float
) -> Array:
    solution = limit.solve(
        start, (0.0, s), s / _STEPS, grid=plane, method="sdirk2", extrapolate=True,
        record_every=_STEPS,
    )  # fmt: skip
    return solution.density(s)


def _approximation(
    limit: HydrodynamicLimit, grid: PhaseSpaceGrid, density: PlaneDensity
) -> Approximation:
    """Combine what two grids give: 𝒫 and its gradient are of order two in the cell."""
    n1, n2, n_alpha = grid.shape
    finer = PhaseSpaceGrid(grid.half_width, (_FINER * n1, _FINER * n2, n_alpha))
    coarse = density(PlaneGrid.of(grid))
    fine = density(PlaneGrid.of(finer))
    # All that p₁ needs of the fine grid is at the centres of the coarse one.
    middle = slice(_FINER // 2, None, _FINER)
    joint = limit.reconstruct(fine, finer)[middle, middle]
    return Approximation(
        _combined(coarse, fine[middle, middle]),
        _combined(limit.reconstruct(coarse, grid), joint),
    )


def _combined(coarse: Array, fine: Array) -> Array:
    return np.ascontiguousarray(fine + _GAIN * (fine - coarse))
