"""Steps of the averaged equation (15) that stay in the interval."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array
from fpsolve.reduced.energy.averages import OrbitAverages
from fpsolve.reduced.energy.grid import EnergyGrid

__all__ = ["Sphere", "Transition"]

Cells = NDArray[np.intp]

# Cells of the transition matrix: their error in a mean is about 1e-6.
_N_CELLS = 1000
# Nodes of the table of coefficients, at |z| = t⁴: crowded at 0, where σ² has a
# logarithm. Linear interpolation between them is good to 1e-6.
_N_NODES = 4097


class Transition:
    """Draw the next cell from exp(ds Q), Q the generator on a thousand cells.

    Exact in ds: a step may be as long as the arclength that is asked for. E G decays
    at A²/2 exactly; elsewhere the error of the cells is left, of order 2 in their
    width.
    """

    def __init__(self, averages: OrbitAverages, noise: float, ds: float) -> None:
        from scipy.linalg import eigh_tridiagonal

        self.grid = cells_of(averages)
        generator = self.grid.generator(noise)
        root = np.sqrt(self.grid.equilibrium)
        # Detailed balance makes it symmetric in the weights √equilibrium.
        beside = np.sqrt(generator.diagonal(1) * generator.diagonal(-1))
        rates, modes = eigh_tridiagonal(generator.diagonal(), beside)
        symmetric = (modes * np.exp(np.minimum(rates, 0.0) * ds)) @ modes.T
        # Row i is the law of the next cell after cell i.
        law = np.maximum(symmetric * root / root[:, None], 0.0)
        cumulated = np.cumsum(law, axis=1)
        cumulated /= cumulated[:, -1:]
        # One ascending sequence: row i lies between i and i + 1.
        self.ladder = (cumulated + np.arange(_N_CELLS)[:, None]).ravel()

    def start(self, g: Array, generator: np.random.Generator) -> Cells:
        """Cells of the energies at the start, by lot between two centres.

        The mean of the two is the energy.
        """
        place = np.interp(g, self.grid.centres, np.arange(_N_CELLS))
        whole = place.astype(np.intp)
        up = generator.uniform(size=g.size) < place - whole
        return np.asarray(whole + up, dtype=np.intp)

    def __call__(self, cells: Cells, generator: np.random.Generator) -> Cells:
        """Take a step from cell to cell."""
        wanted = cells + generator.uniform(size=cells.size)
        found = np.searchsorted(self.ladder, wanted, side="right")
        return np.asarray(np.minimum(found - cells * _N_CELLS, _N_CELLS - 1))

    def energies(self, cells: Cells, generator: np.random.Generator) -> Array:
        """Energies in their cells, with the centres as their means.

        A uniform place has the middle as its mean, the larger of two 2/3 of the width,
        the smaller 1/3; they are mixed such that the mean is right.
        """
        faces, widths = self.grid.faces[:-1], self.grid.widths
        skewness = np.clip(6.0 * (self.grid.centres - faces) / widths - 3.0, -1, 1)
        first, second, lot = generator.uniform(size=(3, cells.size))
        skew = skewness[cells]
        larger, smaller = np.maximum(first, second), np.minimum(first, second)
        pushed = np.where(skew > 0, larger, smaller)
        share = np.where(lot < np.abs(skew), pushed, first)
        return np.asarray(faces[cells] + share * widths[cells])


class Sphere:
    """The step: z = G/g_max as the height of a point that moves on a sphere.

    Brownian motion of rate D = A²/2 on the unit sphere has the height
    dz = -D z ds + √(D (1 - z²)) dW. The drift is that of (15); its noise has an
    additional factor ρ(z) = 2J/(S g_max² (1 - z²)), which is 1 at the poles. So the
    point takes a normal step of variance ρ D ds along its meridian and one of
    (2 - ρ) D ds along its parallel: the latter gives the height no noise but the rest
    of the drift. That is possible because ρ <= 2 for every potential: on an orbit
    w <= g_max, so that J = 2 ∫ (w² - g²) w/√(w² - g²) dr <= (g_max² - g²) S. The
    height never leaves [-1, 1].

    Weak order 1 in theory for smooth coefficients; next to z = 0, where ρ vanishes
    like an inverse logarithm, the observed order is lower.
    """

    def __init__(self, averages: OrbitAverages, noise: float, ds: float) -> None:
        self.g_max = averages.well.g_max
        self.nodes, self.share = noise_of_height(averages)
        self.variance = 0.5 * noise**2 * ds

    def start(self, g: Array, generator: np.random.Generator) -> Array:
        """Heights of the energies at the start."""
        return g / self.g_max

    def energies(self, z: Array, generator: np.random.Generator) -> Array:
        """Energies of the heights."""
        return z * self.g_max

    def __call__(self, z: Array, generator: np.random.Generator) -> Array:
        """Take a step; z and the result in [-1, 1]."""
        share = np.interp(np.sqrt(np.sqrt(np.abs(z))), self.nodes, self.share)
        meridian, parallel = generator.standard_normal((2, z.size))
        meridian *= np.sqrt(self.variance * share)
        parallel *= np.sqrt(self.variance * np.maximum(2.0 - share, 0.0))
        way = np.hypot(meridian, parallel)
        radius = np.sqrt((1.0 - z) * (1.0 + z))
        height = z * np.cos(way) + radius * meridian * np.sinc(way / np.pi)
        return np.asarray(np.clip(height, -1.0, 1.0))


# Neither knows the noise: a well has one of each, for all its samples.
@lru_cache(maxsize=16)
def cells_of(averages: OrbitAverages) -> EnergyGrid:
    """The cells between which `Transition` steps."""
    return EnergyGrid(averages, _N_CELLS, signed=True)


@lru_cache(maxsize=16)
def noise_of_height(averages: OrbitAverages) -> tuple[Array, Array]:
    """Nodes t, with |z| = t⁴, and the factor ρ of `Sphere` there."""
    g_max = averages.well.g_max
    nodes = np.linspace(0.0, 1.0, _N_NODES)
    z = nodes[1:-1] ** 4
    action, period = averages.action(z * g_max), averages.period(z * g_max)
    share = 2.0 * action / (period * g_max**2 * (1.0 - z**2))
    return nodes, np.concatenate([[0.0], share, [1.0]])
