"""Complex Hermite functions times harmonics, for B = ‖ξ‖²/(2σ²) on a fixed belt."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.special import gammaln

from fpsolve._support.arrays import Array, Complex
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.spectral.bases.isotropic import (
    harmonics_of,
    index_of,
    isotropic_sectors,
    on_grid,
)
from fpsolve.spectral.bases.sectors import Integers, Sector, Truncation, Vector
from fpsolve.spectral.bases.states import Move, PolynomialDiscretisation, States

__all__ = ["HermiteDiscretisation"]


def sufficient_harmonics(sigma: float, noise: float, degree: int, digits: float) -> int:
    """Harmonics beyond which a slow mode has less than 10^-digits, at most degree/2.

    From f_{k+1} ≈ (√5/(σ D k)) f_k, D = A²/2, in which √5 is the size of ∇ on the
    smooth modes of interest. A guide only: errors come from comparing truncations.
    """
    ratio = math.sqrt(5.0) / (0.5 * sigma * noise**2)
    k = np.arange(1, degree // 2)
    decades = (k * math.log(ratio) - gammaln(k + 1)) / math.log(10.0)
    return max(4, 1 + int(np.count_nonzero(decades > -digits)))


@dataclass(frozen=True)
class HermiteDiscretisation(PolynomialDiscretisation["_States"]):
    """L in the basis of complex Hermite (Itô) polynomials times exp(i k α).

    With w = (ξ1 + i ξ2)/(√2 σ), a = ∂_w and b = ∂_w̄, the multiplications are
    w = a† + b and w̄ = b† + a, and L takes the harmonic k to

        k + 1 by [(1 + k) a + k b†]/(√2 σ),
        k - 1 by [(1 - k) b - k a†]/(√2 σ),
        k     by -(A²/2) k².

    The state (k, n_a, n_b) has angular index l = n_a - n_b in ξ and degree
    n_a + n_b <= `degree`; M = l + k is conserved. For M = 0 the reflection
    (ξ2, α) → -(ξ2, α) exchanges (k, n_a, n_b) and (-k, n_b, n_a); the even and the
    odd combinations are √2 times the real and the imaginary part of the state.

    Parameters
    ----------
    sigma : float
        Throwing range σ.
    noise : float
        Noise amplitude A.
    """

    sigma: float
    noise: float

    def sectors(self) -> Iterator[Sector]:
        """M = 0 even, M = 0 odd, ±1, ±2, ..."""
        return isotropic_sectors()

    def truncation(self, level: int) -> Truncation:
        """Degree 24, 34, 48, ... (a factor √2 each), harmonics as the noise needs."""
        degree = round(24 * 2 ** (level / 2))
        digits = 9.0 + 2.0 * level
        return Truncation(
            degree, sufficient_harmonics(self.sigma, self.noise, degree, digits)
        )

    def states(self, sector: Sector, truncation: Truncation) -> _States:
        """The basis functions of a sector, by harmonic and then by degree."""
        return _States(sector, truncation)

    def moves(self, states: _States) -> Iterator[Move]:
        """How L changes (k, n_a, n_b), but for its diagonal -(A²/2) k²."""
        k, n_a, n_b = states.k, states.m, states.n
        scale = np.sqrt(0.5) / self.sigma
        yield 1, -1, 0, scale * (1 + k) * np.sqrt(n_a)
        yield 1, 0, 1, scale * k * np.sqrt(n_b + 1)
        yield -1, 0, -1, scale * (1 - k) * np.sqrt(n_b)
        yield -1, 1, 0, -scale * k * np.sqrt(n_a + 1)

    def values(
        self,
        vector: Vector,
        sector: Sector,
        truncation: Truncation,
        grid: PhaseSpaceGrid,
    ) -> Complex:
        """f(ξ, α) on the grid from its coefficients."""
        states = _States(sector, truncation)
        xi1, xi2 = (axis.ravel() for axis in np.broadcast_arrays(*grid.plane()))
        square = (xi1**2 + xi2**2) / (2 * self.sigma**2)
        # Rows: harmonics; columns: points of the plane.
        smallest = np.abs(index_of(sector) - states.k_range)
        modes = _radial_sums(states.table(vector), smallest, square)
        return on_grid(modes, sector, states.k_range, grid)


class _States(States):
    """The basis functions of a sector, by harmonic and then by degree.

    The degrees m and n are n_a and n_b of `HermiteDiscretisation`.
    """

    def __init__(self, sector: Sector, truncation: Truncation) -> None:
        self.degree, self.last = truncation[:2]
        self.folded = sector.parity is not None
        self.k_range = harmonics_of(sector, self.last)
        self.first = int(self.k_range[0])
        smallest = np.abs(index_of(sector) - self.k_range)
        self.counts = np.maximum((self.degree - smallest) // 2 + 1, 0)
        self.offsets = np.cumsum(self.counts) - self.counts
        self.k = np.repeat(self.k_range, self.counts)
        angular = index_of(sector) - self.k
        # Which function of its harmonic a state is.
        self.number = self.all - np.repeat(self.offsets, self.counts)
        self.m = self.number + np.maximum(angular, 0)
        self.n = self.number + np.maximum(-angular, 0)

    def position(self, k: Integers, m: Integers, n: Integers) -> Integers:
        """Where the states stand in a vector; they must be in the basis."""
        offsets: Integers = self.offsets[k - self.first]
        return offsets + np.minimum(m, n)

    def table(self, vector: Vector) -> Vector:
        """Coefficients as an array [harmonic, number], filled up with zeros."""
        width = int(self.counts.max(initial=0))
        result = np.zeros((len(self.k_range), width), dtype=vector.dtype)
        result[self.k - self.first, self.number] = vector
        return result


def _radial_sums(table: Vector, index: Integers, x: Array) -> Vector:
    """Σ_m table[k, m] ψ_m(x), ψ_m = (-1)^m √(m!/(m + l)!) x^{l/2} L_m^{(l)}(x).

    Three-term recurrence of multiplication by x, stable for growing m.
    """
    power = index[:, None].astype(float)
    with np.errstate(divide="ignore", invalid="ignore"):
        logarithm = np.where(power > 0, 0.5 * power * np.log(x), 0.0)
    current = np.exp(logarithm - 0.5 * gammaln(power + 1))
    previous = np.zeros_like(current)
    total: Vector = table[:, :1] * current
    for m in range(1, table.shape[1]):
        lower = np.sqrt((m - 1) * (m - 1 + power))
        step = (x - (2 * m - 1 + power)) * current - lower * previous
        previous, current = current, step / np.sqrt(m * (m + power))
        total = total + table[:, m : m + 1] * current
    return total
