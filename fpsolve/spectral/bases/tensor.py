"""Products of Hermite polynomials times harmonics, for every quadratic B and belt."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fpsolve._support.arrays import Complex
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.spectral.bases.hermite_functions import hermite_polynomials
from fpsolve.spectral.bases.sectors import Integers, Sector, Truncation, Vector
from fpsolve.spectral.bases.states import Move, PolynomialDiscretisation, States

__all__ = ["TensorDiscretisation"]

# Share of a vector below the highest degree that rounding and Arnoldi leave.
EDGE = 1e-3


@dataclass(frozen=True)
class TensorDiscretisation(PolynomialDiscretisation["TensorStates"]):
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

    def states(self, sector: Sector, truncation: Truncation) -> TensorStates:
        """The basis functions of a sector, in the order of its vectors."""
        return TensorStates(sector, truncation)

    def moves(self, states: TensorStates) -> Iterator[Move]:
        """How L changes (k, m, n), but for its diagonal -(A²/2) k²."""
        k, kind = states.k, np.where(states.cosine, 1.0, -1.0)
        root1, root2 = np.sqrt(states.m) / self.sigma1, np.sqrt(states.n) / self.sigma2
        next1 = np.sqrt(states.m + 1) / self.sigma1
        next2 = np.sqrt(states.n + 1) / self.sigma2
        for dk in (1, -1):
            yield dk, -1, 0, 0.5 * (1 + dk * k) * root1
            yield dk, 1, 0, 0.5 * dk * k * next1
            yield dk, 0, -1, 0.5 * kind * (dk + k) * root2
            yield dk, 0, 1, 0.5 * kind * k * next2
        if self.belt_speed:
            yield 0, -1, 0, self.belt_speed * root1

    def on_edge(self, vector: Vector, sector: Sector, truncation: Truncation) -> bool:
        """Whether a vector lies in the highest degree alone.

        An eigenvector there is one of the truncation, not of L: k = 1 has combinations
        of degree m + n that no lower degree is coupled to. Their eigenvalue, -A²/2, is
        the same in every truncation of that parity.
        """
        states = TensorStates(sector, truncation)
        inside = states.m + states.n < truncation.degree
        return bool(np.linalg.norm(vector[inside]) < EDGE * np.linalg.norm(vector))

    def values(
        self,
        vector: Vector,
        sector: Sector,
        truncation: Truncation,
        grid: PhaseSpaceGrid,
    ) -> Complex:
        """f(ξ, α) on the grid from its coefficients."""
        states = TensorStates(sector, truncation)
        degree, harmonics = truncation[:2]
        hermite1 = hermite_polynomials(degree, grid.xi1 / self.sigma1)
        hermite2 = hermite_polynomials(degree, grid.xi2 / self.sigma2)
        weight = np.where(np.arange(harmonics + 1) == 0, 1.0, np.sqrt(2.0))[:, None]
        angle = np.arange(harmonics + 1)[:, None] * grid.alpha
        result = np.zeros(grid.shape, dtype=np.complex128)
        for cosine, circle in ((True, np.cos(angle)), (False, np.sin(angle))):
            chosen = states.cosine == cosine
            table = np.zeros((degree + 1, degree + 1, harmonics + 1), np.complex128)
            where = states.m[chosen], states.n[chosen], states.k[chosen]
            table[where] = vector[chosen]
            # One index at a time: the sum over m, then n, then k.
            plane = np.einsum("mnk,mi->ink", table, hermite1, optimize=True)
            plane = np.einsum("ink,nj->ijk", plane, hermite2, optimize=True)
            result += plane @ (weight * circle)
        return result


class TensorStates(States):
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

    first, folded = 0, True

    def __init__(self, sector: Sector, truncation: Truncation) -> None:
        if sector.M is not None or sector.parity is None:
            raise ValueError(f"`sector` must have a parity and no M, got {sector!r}.")
        self.degree, self.last = truncation[:2]
        shape = (self.last + 1, self.degree + 1, self.degree + 1)
        k, m, n = np.ogrid[: shape[0], : shape[1], : shape[2]]
        cosine = (-1) ** n == sector.parity
        kept = (m + n <= self.degree) & (cosine | (k > 0))
        if sector.parity_along is not None:
            along = (-1) ** (m + k) * np.where(cosine, 1, -1)
            kept &= along == sector.parity_along
        self.k, self.m, self.n = np.nonzero(kept)
        self.cosine = np.broadcast_to(cosine, shape)[self.k, self.m, self.n]
        self._positions = np.full(shape, -1)
        self._positions[kept] = self.all

    def position(self, k: Integers, m: Integers, n: Integers) -> Integers:
        """Where the states stand in a vector; -1 for those of another sector."""
        found: Integers = self._positions[k, m, n]
        return found
