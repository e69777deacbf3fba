"""The stationary density on a belt at rest, which is known: p_S = c e^{−B}."""

from __future__ import annotations

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.density.schemes.scheme import Scheme
from fpsolve.density.stationary.estimates import DENSITY
from fpsolve.density.stationary.result import SteadyState
from fpsolve.density.stationary.strides import Stride
from fpsolve.grids import diagnostics, initial
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.row_sums import MOMENTS
from fpsolve.model.laydown import LayDownModel

__all__ = ["at_rest"]

ROUNDING = 1e-15
FINER = 2


def at_rest(scheme: Scheme, ds: float) -> SteadyState:
    """p_S on the grid, with what the scheme does to it and what the box leaves out.

    Its values at the centres of the cells are exact up to the normalisation on the
    grid, which replaces the mass S = Σ p_S of the exact density there. ∫ |p − p_S| is
    |1 − S| inside, and outside the mass that the box leaves out, which is 1 − S up to
    the error of the midpoint rule.
    """
    model, grid = scheme.model, scheme.grid
    density = initial.equilibrium(grid, model.potential)
    evolution = Stride(scheme, ds)
    moved = diagnostics.l1_distance(evolution(density), density, grid)
    sums, finer = sums_on(model, grid), sums_on(model, twice(grid))
    outside = abs(1.0 - float(finer[0]))
    errors = {
        "step": 0.0,
        "grid": 2.0 * abs(float(sums[0] - finer[0])) + ROUNDING,
        "box": 2.0 * outside,
        "iteration": 0.0,
    }
    return SteadyState(
        density=density,
        residual=moved / evolution.stride,
        grid=grid,
        ds=ds,
        n_applications=1,
        error=sum(errors.values()),
        errors=errors,
        moment_errors=moment_errors(sums, finer, outside, grid),
        splitting=dict.fromkeys((DENSITY, *MOMENTS), 0.0),
        model=model,
    )


def sums_on(model: LayDownModel, grid: PhaseSpaceGrid) -> Array:
    """∫ p_S and its first and second moments by the midpoint rule in the box."""
    xi1, xi2 = grid.plane()
    plane = 2 * np.pi * model.equilibrium(xi1, xi2) * grid.spacing[0] * grid.spacing[1]
    weights = (1.0, xi1, xi2, xi1**2, xi2**2, xi1 * xi2)
    return np.array([float((plane * weight).sum()) for weight in weights])


def twice(grid: PhaseSpaceGrid) -> PhaseSpaceGrid:
    """The same box with twice as many cells in the plane."""
    n1, n2, n_alpha = grid.shape
    return PhaseSpaceGrid(grid.half_width, (FINER * n1, FINER * n2, n_alpha))


def moment_errors(
    sums: Array, finer: Array, outside: float, grid: PhaseSpaceGrid
) -> dict[str, float]:
    """What the cells miss of every moment, and at most the box; α is uniform."""
    here, there = plane_moments(sums), plane_moments(finer)
    half1, half2 = grid.half_widths
    reach1, reach2 = half1 + abs(float(here[0])), half2 + abs(float(here[1]))
    reaches = np.array((reach1, reach2, reach1**2, reach2**2, reach1 * reach2))
    # Beyond the edge the square is larger than at it; with e^{−B} falling over less
    # than the half width, by less than four.
    values = 2 * np.abs(here - there) + (4 * outside + ROUNDING) * reaches
    return dict(zip(MOMENTS, (*map(float, values), ROUNDING, ROUNDING), strict=True))


def plane_moments(sums: Array) -> Array:
    """E ξ1, E ξ2, the variances and the covariance of sums."""
    mean1, mean2, square1, square2, product = sums[1:] / sums[0]
    return np.array(
        (mean1, mean2, square1 - mean1**2, square2 - mean2**2, product - mean1 * mean2)
    )
