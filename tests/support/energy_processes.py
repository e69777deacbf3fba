"""Potentials with a single well, for tests of the energy process."""

from functools import cache

import numpy as np

from fpsolve.model.potentials import (
    IsotropicPotential,
    LinearPotential,
    PowerPotential,
    QuadraticPotential,
)
from fpsolve.reduced.energy import EnergyProcess


def heavy(r):
    """A potential that grows like a logarithm: e^{-B} = (1 + r²)^-3."""
    return 3.0 * np.log1p(np.square(r))


def heavy_derivative(r):
    return 6.0 * r / (1.0 + np.square(r))


def flat(r):
    """B - ln r = y²/40 + y⁴/4 in y = ln r: nearly flat at the circle r = 1."""
    y = np.log(np.maximum(r, 1e-300))
    return y + y**2 / 40 + y**4 / 4


def flat_derivative(r):
    y = np.log(r)
    return (1.0 + y / 20 + y**3) / r


POTENTIALS = {
    "quadratic": QuadraticPotential(),
    "linear": LinearPotential(),
    "quartic, scaled": PowerPotential(4.0, 1.7),
    "steep": PowerPotential(12.0),
    "heavy": IsotropicPotential(heavy, heavy_derivative),
    "flat": IsotropicPotential(flat, flat_derivative),
}
# r² B'' at the circle, by hand.
CURVATURES = {
    "quadratic": 1.0,
    "linear": 0.0,
    "quartic, scaled": 3.0,
    "steep": 11.0,
    "heavy": 2 / 3,
    "flat": -0.95,
}
NOISE = 1.3
PROCESSES = {
    name: EnergyProcess(potential, NOISE) for name, potential in POTENTIALS.items()
}


@cache
def spectrum_of(process, family):
    """Five eigenvalues, computed once for all tests."""
    return process.spectrum(5, family)


def tilted(q=0.9):
    """p = S/(2N(0)) (1 + q g/g_max), the start of an exact solution."""
    process = PROCESSES["quadratic"]

    def density(g):
        share = q / process.g_max
        return process.stationary_density(g, signed=True) * (1 + share * g)

    return density


def exact_masses(grid, s, q=0.9):
    """Cell masses of S/(2N(0)) (1 + q g e^{-A²s/2}/g_max): N and J are known."""
    process = PROCESSES["quadratic"]
    size = np.abs(grid.faces)
    below = process.stationary_distribution(grid.faces, signed=True)
    moment = -process.action(size) / (2 * process._averages.total)
    left = q * np.exp(-(NOISE**2) * s / 2) / process.g_max
    return np.diff(below) + left * np.diff(moment)
