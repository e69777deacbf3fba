"""Bases of polynomials in ξ times harmonics of α: L moves a state to its neighbours."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator
from typing import Generic, TypeVar

import numpy as np
from scipy.sparse import csc_array

from fpsolve._support.arrays import Array
from fpsolve.spectral.bases.sectors import (
    Discretisation,
    Integers,
    Sector,
    Truncation,
    Vector,
)

__all__ = ["Move", "PolynomialDiscretisation", "States", "assembled"]

# Changes of the harmonic and of the two degrees, and the entry for every state.
Move = tuple[int, int, int, Array]
# Rows, columns and entries of a part of a matrix.
Part = tuple[Integers, Integers, Array]
AnyStates = TypeVar("AnyStates", bound="States")


class States(ABC):
    """The basis functions of a sector, in the order of its vectors.

    Attributes
    ----------
    k, m, n : ndarray of int
        Harmonic and both degrees of every state; m + n <= `degree`.
    first, last : int
        The least and the largest harmonic.
    folded : bool
        Whether k >= 0 stands for -k too.
    """

    k: Integers
    m: Integers
    n: Integers
    first: int
    last: int
    degree: int
    folded: bool

    @abstractmethod
    def position(self, k: Integers, m: Integers, n: Integers) -> Integers:
        """Where states within the limits stand in a vector; -1 for other sectors'."""

    @property
    def all(self) -> Integers:
        """Numbers of the states."""
        return np.arange(len(self.k))

    def coupling(self, dk: int, dm: int, dn: int, entries: Array) -> Part:
        """Rows, columns and entries of the move (k, m, n) + (dk, dm, dn)."""
        k, m, n = self.k + dk, self.m + dm, self.n + dn
        inside = (k >= self.first) & (k <= self.last)
        inside &= (m >= 0) & (n >= 0) & (m + n <= self.degree)
        if dk and self.folded:
            # Harmonic 0 couples to 1 and, the same by reflection, to -1; the states of
            # k > 0 are √2 Re or √2 Im of a wave, that of k = 0 is its own.
            entries = np.where((self.k == 0) | (k == 0), np.sqrt(2.0), 1.0) * entries
        rows = np.full(len(k), -1)
        rows[inside] = self.position(k[inside], m[inside], n[inside])
        found = rows >= 0
        return rows[found], self.all[found], entries[found]


class PolynomialDiscretisation(Discretisation, Generic[AnyStates]):
    """L in a basis of states, which it takes to the next degree and harmonic at most.

    L maps the basis (degree, harmonics) into (degree + 1, harmonics + 1), so residuals
    are exact there.
    """

    @abstractmethod
    def states(self, sector: Sector, truncation: Truncation) -> AnyStates:
        """The basis functions of a sector, in the order of its vectors."""

    @abstractmethod
    def moves(self, states: AnyStates) -> Iterator[Move]:
        """How L changes states, but for its diagonal -(A²/2) k²."""

    def enlarged(self, truncation: Truncation) -> Truncation:
        """One more degree and one more harmonic: L f lies there exactly."""
        return Truncation(truncation.degree + 1, truncation.harmonics + 1)

    def harmonics(self, sector: Sector, truncation: Truncation) -> Integers:
        """The harmonic k of every basis function."""
        return self.states(sector, truncation).k

    def matrix(self, sector: Sector, *sizes: int) -> csc_array:
        """The real matrix of L on a sector (columns: images)."""
        states = self.states(sector, Truncation(*sizes))
        decay = -0.5 * self.noise**2 * states.k.astype(float) ** 2
        parts = [states.coupling(*move) for move in self.moves(states)]
        return assembled([(states.all, states.all, decay), *parts], len(states.k))

    def embed(
        self, vector: Vector, sector: Sector, small: Truncation, large: Truncation
    ) -> Vector:
        """Coefficients in the larger basis."""
        inner, outer = self.states(sector, small), self.states(sector, large)
        result = np.zeros(len(outer.k), dtype=vector.dtype)
        result[outer.position(inner.k, inner.m, inner.n)] = vector
        return result


def assembled(parts: Iterable[Part], size: int) -> csc_array:
    """A square matrix from the rows, columns and entries of its parts."""
    rows, columns, entries = map(np.concatenate, zip(*parts, strict=True))
    return csc_array((entries, (rows, columns)), shape=(size, size))
