"""Products of Hermite polynomials times harmonics, for every quadratic B and belt."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array

from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.spectral.bases.sectors import Sector, Truncation, Vector

__all__ = ["TensorDiscretisation"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

# Share of a vector below the highest degree that rounding and Arnoldi leave.
EDGE = 1e-3


@dataclass(frozen=True)
class TensorDiscretisation:
    """L in the basis he_m(ξ1/σ1) he_n(ξ2/σ2) {1, √2 cos kα, √2 sin kα}.

    B = (ξ1²/σ1² + ξ2²/σ2²)/2 and a belt of speed v; he_m are the normalised Hermite
    polynomials, a he_m = √m he_{m-1} and x = a + a†. All states have m + n <= `degree`
    and k <= `harmonics`. With ε = 1 for cosines and -1 for sines, L takes k to

        k ± 1, same kind, by  [a1 ± k x1]/(2 σ1),
        k ± 1, other kind, by  ε [± a2 + k x2]/(2 σ2),
        k     by v a1/σ1 - (A²/2) k²,

    with a factor √2 between k = 0 and 1. The reflection (ξ2, α) → -(ξ2, α) leaves
    cosines with even n and sines with odd n as they are (sector `parity` +1); for
    v = 0 so does (ξ1, α) → (-ξ1, π - α) cosines with even m + k and sines with odd
    m + k (`parity_along` +1).

    L maps the basis (degree, harmonics) into (degree + 1, harmonics + 1), so residuals
    are exact there.

    Parameters
    ----------
    sigma1, sigma2 : float
        Throwing ranges.
    noise : float
        Noise amplitude A.
    belt_speed : float, optional
        Belt speed v.
    """

    sigma1: float
    sigma2: float
    noise: float
    belt_speed: float = 0.0

    def sectors(self) -> Iterator[Sector]:
        """The two parities, or four pairs of them on a fixed belt."""
        for parity in (1, -1):
            if self.belt_speed:
                yield Sector(parity=parity)
            else:
                yield Sector(parity=parity, parity_along=1)
                yield Sector(parity=parity, parity_along=-1)

    def truncation(self, level: int) -> Truncation:
        """The basis of a level, 0, 1, 2, ..."""
        return Truncation(12 + 6 * level, 8 + 4 * level)

    def enlarged(self, truncation: Truncation) -> Truncation:
        """One more degree and one more harmonic: L f lies there exactly."""
        return Truncation(truncation.degree + 1, truncation.harmonics + 1)

    def states(self, sector: Sector, truncation: Truncation) -> TensorStates:
        """The basis functions of a sector, in the order of its vectors."""
        return TensorStates(sector, truncation)

    def harmonics(self, sector: Sector, truncation: Truncation) -> Integers:
        """The harmonic k of every basis function."""
        return TensorStates(sector, truncation).k

    def matrix(self, sector: Sector, degree: int, harmonics: int) -> csc_array:
        """The real matrix of L on a sector (columns: images)."""
        states = TensorStates(sector, Truncation(degree, harmonics))
        k, kind = states.k, np.where(states.cosine, 1.0, -1.0)
        root1, root2 = np.sqrt(states.m) / self.sigma1, np.sqrt(states.n) / self.sigma2
        next1 = np.sqrt(states.m + 1) / self.sigma1
        next2 = np.sqrt(states.n + 1) / self.sigma2
        parts = [(states.all, states.all, -0.5 * self.noise**2 * k.astype(float) ** 2)]
        for dk in (1, -1):
            parts += [
                states.coupling(dk, -1, 0, 0.5 * (1 + dk * k) * root1),
                states.coupling(dk, 1, 0, 0.5 * dk * k * next1),
                states.coupling(dk, 0, -1, 0.5 * kind * (dk + k) * root2),
                states.coupling(dk, 0, 1, 0.5 * kind * k * next2),
            ]
        if self.belt_speed:
            parts.append(states.coupling(0, -1, 0, self.belt_speed * root1))
        rows, columns, entries = (
            np.concatenate(column) for column in zip(*parts, strict=True)
        )
        return csc_array((entries, (rows, columns)), shape=(len(k), len(k)))

    def on_edge(self, vector: Vector, sector: Sector, truncation: Truncation) -> bool:
        """Whether a vector lies in the highest degree alone.

        An eigenvector there is one of the truncation, not of L: k = 1 has combinations
        of degree m + n that no lower degree is coupled to. Their eigenvalue, -A²/2, is
        the same in every truncation of that parity.
        """
        states = TensorStates(sector, truncation)
        inside = states.m + states.n < truncation.degree
        return bool(np.linalg.norm(vector[inside]) < EDGE * np.linalg.norm(vector))

    def embed(
        self, vector: Vector, sector: Sector, small: Truncation, large: Truncation
    ) -> Vector:
        """Coefficients in the larger basis."""
        inner, outer = TensorStates(sector, small), TensorStates(sector, large)
        result = np.zeros(len(outer.k), dtype=vector.dtype)
        result[outer.position(inner.k, inner.m, inner.n)] = vector
        return result

    def values(
        self,
        vector: Vector,
        sector: Sector,
        truncation: Truncation,
        grid: PhaseSpaceGrid,
    ) -> NDArray[np.complex128]:
        """f(ξ, α) on the grid from its coefficients."""
        states = TensorStates(sector, truncation)
        degree, harmonics = truncation
        hermite1 = hermite_functions(degree, grid.xi1 / self.sigma1)
        hermite2 = hermite_functions(degree, grid.xi2 / self.sigma2)
        weight = np.where(np.arange(harmonics + 1) == 0, 1.0, np.sqrt(2.0))[:, None]
        angle = np.arange(harmonics + 1)[:, None] * grid.alpha
        result = np.zeros(grid.shape, dtype=np.complex128)
        for cosine, circle in ((True, np.cos(angle)), (False, np.sin(angle))):
            chosen = states.cosine == cosine
            table = np.zeros((degree + 1, degree + 1, harmonics + 1), np.complex128)
            where = states.m[chosen], states.n[chosen], states.k[chosen]
            table[where] = vector[chosen]
            plane = np.einsum("mnk,mi->ink", table, hermite1, optimize=True)
            plane = np.einsum("ink,nj->ijk", plane, hermite2, optimize=True)
            result += plane @ (weight * circle)
        return result


class TensorStates:
    """The basis functions (k, m, n) of a sector: by k, then m, then n.

    In a sector of one `parity`, n decides between cosine and sine; the second parity
    on a fixed belt then leaves every other m.

    Attributes
    ----------
    k, m, n : ndarray of int
        Harmonic, degree in ξ1 and degree in ξ2 of every state.
    cosine : ndarray of bool
        Whether it is √2 cos kα (1 for k = 0) rather than √2 sin kα.
    """

    def __init__(self, sector: Sector, truncation: Truncation) -> None:
        if sector.M is not None or sector.parity is None:
            raise ValueError(f"`sector` must have a parity and no M, got {sector!r}.")
        self.degree, self.n_harmonics = truncation
        shape = (self.n_harmonics + 1, self.degree + 1, self.degree + 1)
        k, m, n = np.ogrid[: shape[0], : shape[1], : shape[2]]
        cosine = (-1) ** n == sector.parity
        kept = (m + n <= self.degree) & (cosine | (k > 0))
        if sector.parity_along is not None:
            along = (-1) ** (m + k) * np.where(cosine, 1, -1)
            kept &= along == sector.parity_along
        self.k, self.m, self.n = np.nonzero(kept)
        self.cosine = np.broadcast_to(cosine, shape)[self.k, self.m, self.n]
        self.all = np.arange(len(self.k))
        self._positions = np.full(shape, -1)
        self._positions[kept] = self.all

    def position(self, k: Integers, m: Integers, n: Integers) -> Integers:
        """Where the states stand in a vector; -1 for those outside the basis."""
        return self._positions[k, m, n]

    def coupling(
        self, dk: int, dm: int, dn: int, entries: Array
    ) -> tuple[Integers, Integers, Array]:
        """Rows, columns and entries of the move (k, m, n) + (dk, dm, dn)."""
        k, m, n = self.k + dk, self.m + dm, self.n + dn
        inside = (k >= 0) & (k <= self.n_harmonics)
        inside &= (m >= 0) & (n >= 0) & (m + n <= self.degree)
        if dk:
            # 1 is not √2 cos 0, and reaches k = 1 and -1.
            entries = np.where((self.k == 0) | (k == 0), np.sqrt(2.0), 1.0) * entries
        rows = np.full(len(k), -1)
        rows[inside] = self.position(k[inside], m[inside], n[inside])
        found = rows >= 0
        return rows[found], self.all[found], entries[found]


def hermite_functions(degree: int, x: Array) -> Array:
    """he_m(x), m = 0 ... degree, orthonormal for exp(-x²/2)/√(2π); shape (m, x)."""
    result = np.ones((degree + 1, len(x)))
    if degree > 0:
        result[1] = x
    for m in range(1, degree):
        result[m + 1] = (x * result[m] - np.sqrt(m) * result[m - 1]) / np.sqrt(m + 1)
    return result
