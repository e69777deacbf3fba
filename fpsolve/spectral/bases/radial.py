"""Radial functions times harmonics, for every isotropic B on a fixed belt."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.sparse import csc_array

from fpsolve._support.arrays import Array, Complex
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.potentials.potential import Potential
from fpsolve.model.potentials.power import PowerPotential
from fpsolve.spectral.bases.isotropic import (
    harmonics_of,
    index_of,
    isotropic_sectors,
    on_grid,
)
from fpsolve.spectral.bases.radial_basis import RadialBasis, radial_basis
from fpsolve.spectral.bases.sectors import (
    Discretisation,
    Integers,
    Sector,
    Truncation,
    Vector,
)
from fpsolve.spectral.bases.states import assembled

__all__ = ["RadialDiscretisation"]

# Of an angular index and a degree: basis functions and their derivatives.
Table = Callable[[int, int], tuple[Array, Array]]

# Relative size below which an entry is rounding of an exact zero: for a polynomial B
# the blocks are banded.
ROUNDING = 1e-14


@dataclass(frozen=True)
class RadialDiscretisation(Discretisation):
    """L in the basis g_j(r) exp(i l φ + i k α), l = M - k, of one angular index M.

    L takes the harmonic k to

        k + 1, l - 1 by ½ [g' + (l/r) g + k B' g],
        k - 1, l + 1 by ½ [g' - (l/r) g - k B' g],
        k            by -(A²/2) k².

    The two off-diagonal parts are negative adjoints in L²(r exp(-B) dr). Only the first
    is computed, by quadrature, and the second is its negative transpose, so that
    L + L* is diagonal and no eigenvalue has a positive real part, whatever the error
    of the quadrature. For M = 0 the reflection (ξ2, α) → -(ξ2, α) exchanges k and -k.

    `RadialBasis` chooses the functions g_j. For a quadratic B they are those of
    `HermiteDiscretisation`. For a polynomial B in r² residuals in `enlarged` bases are
    exact, otherwise they are lower bounds and `residual` gives the true ones.

    Parameters
    ----------
    potential : Potential
        Isotropic, growing at least linearly.
    noise : float
        Noise amplitude A.
    """

    potential: Potential
    noise: float

    def sectors(self) -> Iterator[Sector]:
        """M = 0 even, M = 0 odd, ±1, ±2, ..."""
        return isotropic_sectors()

    def truncation(self, level: int) -> Truncation:
        """The basis of a level, 0, 1, 2, ..."""
        if self._basis(1).smooth:
            return Truncation(24 + 12 * level, 12 + 8 * level)
        # Two functions of √r for each degree: blocks are four times as large.
        return Truncation(16 + 6 * level, 8 + 6 * level)

    def enlarged(self, truncation: Truncation) -> Truncation:
        """One more harmonic, and the degree that B' adds."""
        degree, harmonics = truncation[:2]
        step = 1 + degree // 4
        if isinstance(self.potential, PowerPotential) and self._basis(degree).smooth:
            step = int(self.potential.exponent) - 1
        return Truncation(degree + step, harmonics + 1)

    def harmonics(self, sector: Sector, truncation: Truncation) -> Integers:
        """The harmonic k of every basis function."""
        k, counts = self._layout(sector, truncation)
        return np.repeat(k, counts)

    def matrix(self, sector: Sector, *sizes: int) -> csc_array:
        """The real matrix of L on a sector (columns: images)."""
        truncation = Truncation(*sizes)
        degree, (k, counts) = truncation.degree, self._layout(sector, truncation)
        offsets = np.cumsum(counts) - counts
        size = int(counts.sum())
        diagonal = np.arange(size)
        decay = -0.5 * self.noise**2 * np.repeat(k, counts).astype(float) ** 2
        parts = [(diagonal, diagonal, decay)]
        for column in range(len(k) - 1):
            block = self._raising(sector, int(k[column]), degree)
            weight = np.abs(block)
            i, j = np.nonzero(weight > ROUNDING * np.max(weight, initial=0.0))
            rows, columns = offsets[column + 1] + i, offsets[column] + j
            parts.append((rows, columns, block[i, j]))
            parts.append((columns, rows, -block[i, j]))
        return assembled(parts, size)

    def embed(
        self, vector: Vector, sector: Sector, small: Truncation, large: Truncation
    ) -> Vector:
        """Coefficients in the larger basis."""
        inner, outer = self._layout(sector, small), self._layout(sector, large)
        table = np.zeros((len(outer[0]), max(outer[1], default=0)), dtype=np.complex128)
        first = int(inner[0][0] - outer[0][0])
        for k, part in enumerate(self._split(vector, inner[1]), start=first):
            table[k, : len(part)] = part
        rows = [row[:count] for row, count in zip(table, outer[1], strict=True)]
        result = np.concatenate(rows)
        return result if np.iscomplexobj(vector) else result.real

    def values(
        self,
        vector: Vector,
        sector: Sector,
        truncation: Truncation,
        grid: PhaseSpaceGrid,
    ) -> Complex:
        """f(ξ, α) on the grid from its coefficients."""
        xi1, xi2 = (axis.ravel() for axis in np.broadcast_arrays(*grid.plane()))
        # A square grid has every radius up to eight times.
        r, place = np.unique(np.hypot(xi1, xi2), return_inverse=True)
        if r[0] == 0:
            # A limit exists at the origin, but the formulas divide by r.
            r[0] = 1e-12 * r[-1]
        k, _ = self._layout(sector, truncation)
        evaluate = partial(self._basis(truncation.degree).evaluate, r)
        radial, _ = self._radial(vector, sector, truncation, evaluate)
        return on_grid(radial[:, place], sector, k, grid)

    def residual(
        self,
        vector: Vector,
        eigenvalue: complex,
        sector: Sector,
        truncation: Truncation,
    ) -> float:
        """‖L f - λ f‖/‖f‖ in L²(μ), by quadrature of L f itself.

        Unlike a residual in a larger basis it counts all of L f, within the error of
        the rule; where B has a kink it falls more slowly with the truncation than the
        error of λ.
        """
        basis = self._basis(truncation.degree)
        r, slope = basis.rule.r, basis.rule.slope
        k, _ = self._layout(sector, truncation)
        # Times the root of the weight: its square underflows far out, g overflows.
        g, derivative = self._radial(vector, sector, truncation, basis.weighted)
        tilt = ((index_of(sector) - k)[:, None] / r + k[:, None] * slope) * g
        up, down = 0.5 * (derivative + tilt), 0.5 * (derivative - tilt)
        scale = _folding(sector, k)[:, None]
        defect = np.zeros((len(k) + 2, len(r)), dtype=np.complex128)
        own = 0.5 * self.noise**2 * k.astype(float) ** 2 + eigenvalue
        defect[1:-1] -= own[:, None] * g
        defect[2:] += scale * up
        defect[1:-2] += scale[:-1] * down[1:]
        if sector.parity is None:
            defect[0] = down[0]
        return float(np.linalg.norm(defect) / np.linalg.norm(vector))

    def _basis(self, degree: int) -> RadialBasis:
        return radial_basis(self.potential, degree)

    def _layout(
        self, sector: Sector, truncation: Truncation
    ) -> tuple[Integers, Integers]:
        """Harmonics, and how many radial functions each has."""
        degree, harmonics = truncation[:2]
        k = harmonics_of(sector, harmonics)
        basis, M = self._basis(degree), index_of(sector)
        counts = [basis.count(n, M - n, degree) for n in map(int, k)]
        return k, np.array(counts, dtype=np.int64)

    def _raising(self, sector: Sector, k: int, degree: int) -> Array:
        """From the harmonic k to k + 1, in the basis of the sector."""
        block = self._basis(degree).raising(k, index_of(sector) - k, degree)
        return block * float(_folding(sector, np.array([k]))[0])

    def _radial(
        self, vector: Vector, sector: Sector, truncation: Truncation, table: Table
    ) -> tuple[Complex, Complex]:
        """g_k and g_k', rows: harmonics; the table gives those of the basis."""
        k, counts = self._layout(sector, truncation)
        parts = self._split(vector, counts)
        known: dict[int, tuple[Array, Array]] = {}
        rows = []
        for angular, part in zip(index_of(sector) - k, parts, strict=True):
            power = self._basis(truncation.degree).power(angular)
            if power not in known:
                known[power] = table(angular, truncation.degree)
            rows.append([part @ functions[: len(part)] for functions in known[power]])
        g, derivative = np.swapaxes(np.array(rows), 0, 1)
        return g, derivative

    @staticmethod
    def _split(vector: Vector, counts: Integers) -> list[Complex]:
        return np.split(vector.astype(np.complex128), np.cumsum(counts)[:-1])


def _folding(sector: Sector, k: Integers) -> Array:
    """√2 between k = 0 and 1 of a folded sector, else 1.

    The harmonic 0 couples to 1 and, the same by reflection, to -1.
    """
    folded = (k == 0) & (sector.parity is not None)
    return np.where(folded, np.sqrt(2.0), 1.0)
