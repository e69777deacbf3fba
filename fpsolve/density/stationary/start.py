"""Where to begin: the density of the limit of large noise."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.optimize import brentq
from scipy.special import i0e, i1e

from fpsolve._support.arrays import Array
from fpsolve.grids import initial
from fpsolve.grids.smooth import SmoothPhaseSpaceGrid

__all__ = ["concentration_of", "start_on"]


def concentration_of(speed: float) -> float:
    """k with I₁(k)/I₀(k) = v: angles von Mises with it balance a belt of speed v."""
    if speed == 0.0:
        return 0.0
    # I₁/I₀ lies above 1 − 1/(2k) − 1/(2k²): at this k it is beyond v.
    largest = 2.0 / (1.0 - speed)

    def excess(k: float) -> float:
        return float(i1e(k) / i0e(k)) - speed

    return float(brentq(excess, 0.0, largest, xtol=2e-12 * speed))


def start_on(grid: Any, model: Any) -> Array:
    """exp(−B + f e·ξ − k e·τ)/c, where −γ′ = v e and f = A²k/2.

    For large noise the belt is a force; the mean force and direction are then exact.
    The curvature of a smooth fibre begins as that of a free one.

    Parameters
    ----------
    grid : PhaseSpaceGrid or SmoothPhaseSpaceGrid
    model : LayDownModel or SmoothLayDownModel
        On a belt of constant speed.
    """
    if isinstance(grid, SmoothPhaseSpaceGrid):
        basic = start_on(grid.phase_space, model)
        return initial.with_curvature(basic, grid, model.curvature_variance)
    if model.curve.fixed:
        return initial.equilibrium(grid, model.potential)
    velocity1, velocity2 = (float(one) for one in model.curve.velocity(0.0))
    speed = math.hypot(velocity1, velocity2)
    k = concentration_of(speed)
    towards = (-velocity1 / speed, -velocity2 / speed)
    force = 0.5 * model.noise**2 * k
    xi1, xi2 = grid.plane()
    exponent = force * (towards[0] * xi1 + towards[1] * xi2)
    plane = exponent - model.potential.value(xi1, xi2)
    along = towards[0] * np.cos(grid.alpha) + towards[1] * np.sin(grid.alpha)
    p = np.exp(plane - plane.max())[:, :, None] * np.exp(-k * (along + 1.0))
    normalised: Array = p / (float(p.sum()) * grid.cell_volume)
    return np.ascontiguousarray(normalised)
