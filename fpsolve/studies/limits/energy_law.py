"""The law of the energy G, smoothed: twelve numbers from any description of it."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.special import i0e

from fpsolve._support.arrays import Array
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.paths.laws import GaussianLaw
from fpsolve.reduced.energy.grid import EnergyGrid
from fpsolve.reduced.energy.process import EnergyProcess

__all__ = ["N_FUNCTIONS", "SmoothedLaw", "density_of", "energy_masses"]

N_FUNCTIONS = 12
_DEGREE = 3
# Points on the circle of polar angles; the mean over it converges geometrically.
_N_POLAR = 48


class SmoothedLaw:
    """E b_j(G), b_j the cubic B-splines on [-g_max, g_max] with equidistant knots.

    The splines are positive and add up to one, so that Σ|E b_j - E' b_j| is at most
    the total variation between two laws of G, and tends to it with more splines.
    They are smooth in phase space, so that sums over grid cells are accurate, and no
    bins have to be shared among paths, cells of a grid and cells of energy.

    Parameters
    ----------
    process : EnergyProcess
    """

    def __init__(self, process: EnergyProcess) -> None:
        self.process = process
        inner = np.linspace(-1.0, 1.0, N_FUNCTIONS - _DEGREE + 1)
        ends = np.ones(_DEGREE)
        self.knots = process.g_max * np.concatenate([-ends, inner, ends])

    def of_density(self, p: Array, grid: PhaseSpaceGrid) -> Array:
        """From a density on a phase-space grid, normalised; shape (12,)."""
        energies = np.broadcast_to(self.process.energy(*grid.mesh()), grid.shape)
        return self.weighted(energies.ravel(), p.ravel() / p.sum())

    def of_masses(self, masses: Array, grid: EnergyGrid) -> Array:
        """From masses of energy cells."""
        return self.weighted(grid.centres, masses)

    def of_energies(self, g: Array) -> tuple[Array, Array]:
        """From independent energies: means and their standard errors."""
        basis = self._basis(g)
        mean = np.asarray(basis.mean(axis=0)).ravel()
        square = np.asarray(basis.power(2).mean(axis=0)).ravel()
        return mean, np.sqrt((square - mean**2) / g.size)

    def weighted(self, g: Array, weights: Array) -> Array:
        """Σ weights b_j(g)."""
        return np.asarray(self._basis(g).T @ weights)

    def _basis(self, g: Array) -> Any:
        from scipy.interpolate import BSpline

        # Rounding may carry an energy beyond the last knot.
        inside = np.clip(g, self.knots[0], self.knots[-1])
        return BSpline.design_matrix(inside, self.knots, _DEGREE)


def density_of(law: GaussianLaw) -> Any:
    """The density p(ξ1, ξ2, α) of a Gaussian law, as a function.

    Written out: it is asked for at millions of points, where the distributions of
    scipy look at each of their arguments several times.
    """
    mean1, mean2 = law.mean
    (first, mixed), (_, second) = np.linalg.inv(np.array(law.variance))
    angle, concentration = law.angle or 0.0, law.concentration
    scale = np.sqrt(first * second - mixed**2) / (2.0 * np.pi) ** 2
    scale /= i0e(concentration)

    def density(xi1: Array, xi2: Array, alpha: Array) -> Array:
        x, y = xi1 - mean1, xi2 - mean2
        exponent = -0.5 * (x * (first * x + 2.0 * mixed * y) + second * y**2)
        if concentration > 0:
            exponent = exponent + concentration * (np.cos(alpha - angle) - 1.0)
        return np.asarray(scale * np.exp(exponent))

    return density


def energy_masses(law: GaussianLaw, process: EnergyProcess, grid: EnergyGrid) -> Array:
    """Law of G when (ξ, α) has a Gaussian law: masses of energy cells, of sum one.

    The density of G is that of the stationary law times the average of p/p_S over the
    orbit of energy g and over its rotations, taken at the centres: order 2.
    """
    potential = process.potential
    density = density_of(law)
    polar = 2.0 * np.pi * np.arange(_N_POLAR) / _N_POLAR

    def ratio(r: Array, beta: Array) -> Array:
        total = np.zeros(r.shape)
        for phi in polar:
            total += density(r * np.cos(phi), r * np.sin(phi), beta + phi)
        return total / _N_POLAR * np.exp(potential.radial_value(r))

    masses = grid.equilibrium * process.orbit_average(ratio, grid.centres)
    return np.asarray(masses / masses.sum())
