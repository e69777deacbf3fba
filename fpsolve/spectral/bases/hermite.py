"""Complex Hermite functions times harmonics, for B = ‖ξ‖²/(2σ²) on a fixed belt."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array
from scipy.special import gammaln

from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.spectral.bases.sectors import Sector, Truncation, Vector

__all__ = ["HermiteDiscretisation"]

Integers = NDArray[np.int64]


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
class HermiteDiscretisation:
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

    L maps the basis (degree, harmonics) into (degree + 1, harmonics + 1), so residuals
    are exact there.

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
        yield Sector(0, 1)
        yield Sector(0, -1)
        yield from (Sector(M) for M in itertools.count(1))

    def truncation(self, level: int) -> Truncation:
        """Degree 24, 34, 48, ... (a factor √2 each), harmonics as the noise needs."""
        degree = round(24 * 2 ** (level / 2))
        digits = 9.0 + 2.0 * level
        return Truncation(
            degree, sufficient_harmonics(self.sigma, self.noise, degree, digits)
        )

    def enlarged(self, truncation: Truncation) -> Truncation:
        """One more degree and one more harmonic: L f lies there exactly."""
        return Truncation(truncation.degree + 1, truncation.harmonics + 1)

    def harmonics(self, sector: Sector, truncation: Truncation) -> Integers:
        """The harmonic k of every basis function."""
        return _States(sector, truncation).k

    def matrix(self, sector: Sector, degree: int, harmonics: int) -> csc_array:
        """The real matrix of L on a sector (columns: images)."""
        states = _States(sector, Truncation(degree, harmonics))
        k, n_a, n_b = states.k, states.n_a, states.n_b
        scale = np.sqrt(0.5) / self.sigma
        moves = (
            (1, -1, 0, scale * (1 + k) * np.sqrt(n_a)),
            (1, 0, 1, scale * k * np.sqrt(n_b + 1)),
            (-1, 0, -1, scale * (1 - k) * np.sqrt(n_b)),
            (-1, 1, 0, -scale * k * np.sqrt(n_a + 1)),
        )
        parts = [states.coupling(*move) for move in moves]
        parts.append(
            (states.all, states.all, -0.5 * self.noise**2 * k.astype(float) ** 2)
        )
        rows, columns, entries = (
            np.concatenate(column) for column in zip(*parts, strict=True)
        )
        return csc_array((entries, (rows, columns)), shape=(len(k), len(k)))

    def embed(
        self, vector: Vector, sector: Sector, small: Truncation, large: Truncation
    ) -> Vector:
        """Coefficients in the larger basis."""
        inner, outer = _States(sector, small), _States(sector, large)
        result = np.zeros(len(outer.k), dtype=vector.dtype)
        result[outer.position(inner.k, inner.n_a, inner.n_b)] = vector
        return result

    def values(
        self,
        vector: Vector,
        sector: Sector,
        truncation: Truncation,
        grid: PhaseSpaceGrid,
    ) -> NDArray[np.complex128]:
        """f(ξ, α) on the grid from its coefficients."""
        states = _States(sector, truncation)
        xi1, xi2 = (axis.ravel() for axis in np.broadcast_arrays(*grid.plane()))
        radial = states.table(vector)
        # Rows: harmonics; columns: points of the plane.
        angular = states.M - states.k_range
        modes = _radial_sums(
            radial, np.abs(angular), (xi1**2 + xi2**2) / (2 * self.sigma**2)
        )
        plane = np.exp(1j * angular[:, None] * np.arctan2(xi2, xi1))
        circle = np.exp(1j * states.k_range[:, None] * grid.alpha)
        if sector.parity is None:
            result = (modes * plane).T @ circle
        else:
            # √2 Re or √2 Im of every state; the harmonic 0 is real already.
            modes = modes * np.where(states.k_range == 0, 0.5, np.sqrt(0.5))[:, None]
            state = (modes * plane).T @ circle
            mirrored = (modes * plane.conj()).T @ circle.conj()
            even = sector.parity == 1
            result = state + mirrored if even else (state - mirrored) / 1j
        return np.asarray(result, dtype=np.complex128).reshape(grid.shape)


class _States:
    """The basis functions of a sector, by harmonic and then by degree.

    For M = 0 only k >= 0 (even) or k >= 1 (odd) are kept: the others follow by the
    reflection.
    """

    def __init__(self, sector: Sector, truncation: Truncation) -> None:
        if sector.M is None:
            raise ValueError(f"`sector` must have an angular index M, got {sector!r}.")
        degree, harmonics = truncation
        first = {None: -harmonics, 1: 0, -1: 1}[sector.parity]
        self.parity, self.degree, self.M = sector.parity, degree, sector.M
        self.k_range = np.arange(first, harmonics + 1)
        smallest = np.abs(self.M - self.k_range)
        self.counts = np.maximum((degree - smallest) // 2 + 1, 0)
        self.offsets = np.cumsum(self.counts) - self.counts
        self.k = np.repeat(self.k_range, self.counts)
        self.all = np.arange(len(self.k))
        self.m = self.all - np.repeat(self.offsets, self.counts)
        angular = self.M - self.k
        self.n_a = self.m + np.maximum(angular, 0)
        self.n_b = self.m + np.maximum(-angular, 0)

    def position(self, k: Integers, n_a: Integers, n_b: Integers) -> Integers:
        """Where the states stand in a vector; they must be in the basis."""
        offsets: Integers = self.offsets[k - self.k_range[0]]
        return offsets + np.minimum(n_a, n_b)

    def coupling(
        self, dk: int, d_a: int, d_b: int, entries: NDArray[np.float64]
    ) -> tuple[Integers, Integers, NDArray[np.float64]]:
        """Rows, columns and entries of the move (k, n_a, n_b) + (dk, d_a, d_b)."""
        k, n_a, n_b = self.k + dk, self.n_a + d_a, self.n_b + d_b
        inside = (k >= self.k_range[0]) & (k <= self.k_range[-1])
        inside &= (n_a >= 0) & (n_b >= 0) & (n_a + n_b <= self.degree)
        if self.parity is not None:
            # Harmonic 0 couples to 1 and, the same by reflection, to -1.
            entries = np.where((self.k == 0) | (k == 0), np.sqrt(2.0), 1.0) * entries
        rows = self.position(k[inside], n_a[inside], n_b[inside])
        return rows, self.all[inside], entries[inside]

    def table(self, vector: Vector) -> Vector:
        """Coefficients as an array [harmonic, m], filled up with zeros."""
        width = int(self.counts.max(initial=0))
        result = np.zeros((len(self.k_range), width), dtype=vector.dtype)
        result[self.k - self.k_range[0], self.m] = vector
        return result


def _radial_sums(table: Vector, index: Integers, x: NDArray[np.float64]) -> Vector:
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
