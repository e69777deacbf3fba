"""One start for both sides: a density on the grid and the law that paths begin with."""

from __future__ import annotations

from typing import Any

from fpsolve._support.arrays import Array
from fpsolve.grids import diagnostics, initial
from fpsolve.grids.phase_space import PhaseSpaceGrid

__all__ = ["density_and_law"]

# A density whose mass is off by more would be compared with paths of mass one.
MASS_ERROR = 1e-6


def density_and_law(p0: Any, grid: PhaseSpaceGrid) -> tuple[Array, Any]:
    """The start as a density on the grid and as a law with `.sample`.

    Parameters
    ----------
    p0 : ndarray, shape grid.shape, or GaussianLaw, EquilibriumLaw, DensityLaw
    grid : PhaseSpaceGrid

    Raises
    ------
    ValueError, TypeError
        If the start has no density, none on this grid, or not the mass one.
    """
    from fpsolve.paths.laws import DensityLaw, EquilibriumLaw, GaussianLaw, PointLaw

    if type(p0) is PointLaw:
        raise ValueError(
            "`p0` must have a density, got a PointLaw; a GaussianLaw with a variance "
            "of a few cells is what a grid can hold."
        )
    if type(p0) is GaussianLaw:
        density = initial.gaussian(
            grid, p0.mean, p0.variance, p0.angle, p0.concentration
        )
        return density, p0
    if type(p0) is EquilibriumLaw:
        return initial.equilibrium(grid, p0.potential), p0
    if type(p0) is DensityLaw:
        return _checked(p0.p, grid), p0
    if hasattr(p0, "sample"):
        raise TypeError(
            "`p0` must be a density on the grid or a law of fpsolve.paths, got "
            f"{type(p0).__name__}, whose density is not known; pass the density."
        )
    density = _checked(p0, grid)
    return density, DensityLaw(grid, density)


def _checked(p0: Any, grid: PhaseSpaceGrid) -> Array:
    density = grid.check(p0, "p0")
    mass = diagnostics.mass(density, grid)
    if not abs(mass - 1.0) <= MASS_ERROR:
        raise ValueError(f"`p0` must have mass 1, got {mass:g}; divide it by its mass.")
    return density
