"""The basis functions of a smooth fibre in its own frame, sorted into sectors."""

from __future__ import annotations

import math

import numpy as np
from scipy.sparse import csc_array

from fpsolve._support.arrays import Array
from fpsolve.spectral.bases.isotropic import index_of
from fpsolve.spectral.bases.sectors import Integers, Sector, Truncation, Vector

__all__ = ["BodyStates"]


class BodyStates:
    """The basis functions (n_a, n_b, j) of a sector.

    Those of the plane come by degree and then by n_a, each with all j. For M = 0 a
    state n_a > n_b stands for the pair (|n_a, n_b⟩ ± (-1)^j |n_b, n_a⟩)/√2, the sign
    being the parity of the sector.

    Attributes
    ----------
    m, n, j : ndarray of int
        Both degrees in the plane, n_a and n_b, and that in κ.
    degree, curvature : int
        The largest m + n and j.
    n_plane : int
        How many pairs (m, n) there are, folded or not.
    """

    def __init__(self, sector: Sector, truncation: Truncation) -> None:
        index_of(sector)
        self.parity = sector.parity
        self.degree, self.curvature = truncation.degree, truncation.curvature
        total = np.arange(self.degree + 1)
        sums = np.repeat(total, total + 1)
        self._m = np.arange(len(sums)) - sums * (sums + 1) // 2
        self._n = sums - self._m
        self.n_plane = len(sums)
        m, n = (np.repeat(one, self.curvature + 1) for one in (self._m, self._n))
        j = np.tile(np.arange(self.curvature + 1), self.n_plane)
        kept = self._kept(m, n, j)
        self.m, self.n, self.j = m[kept], n[kept], j[kept]
        self._positions = np.where(kept, np.cumsum(kept) - 1, -1)

    def _kept(self, m: Integers, n: Integers, j: Integers) -> Integers:
        """Which of all states stand for themselves or for a pair."""
        if self.parity is None:
            return np.ones(len(m), bool)
        own = (m == n) & ((-1) ** j == self.parity)
        kept: Integers = own | (m > n)
        return kept

    @property
    def angular(self) -> Integers:
        """l = n_a - n_b of every state."""
        difference: Integers = self.m - self.n
        return difference

    @property
    def plane_angular(self) -> Integers:
        """l of every pair (m, n)."""
        difference: Integers = self._m - self._n
        return difference

    def numbers(self, m: Integers, n: Integers, j: Integers) -> Integers:
        """Where states stand in a vector, -1 for those of other sectors."""
        found: Integers = self._positions[self._all_numbers(m, n, j)]
        return found

    def lowering(self) -> tuple[csc_array, csc_array]:
        """a and b on the pairs (m, n)."""
        return self._lowered(self._m - 1, self._n, self._m), self._lowered(
            self._m, self._n - 1, self._n
        )

    def _lowered(self, m: Integers, n: Integers, square: Integers) -> csc_array:
        inside = np.flatnonzero((m >= 0) & (n >= 0))
        entries: Array = np.sqrt(square[inside].astype(float))
        rows = self._plane_numbers(m[inside], n[inside])
        shape = (self.n_plane, self.n_plane)
        return csc_array((entries, (rows, inside)), shape=shape)

    @property
    def folding(self) -> csc_array:
        """The isometry that takes a vector of the sector to one of all states."""
        columns = np.arange(len(self.m))
        rows = self._all_numbers(self.m, self.n, self.j)
        entries = np.ones(len(columns))
        if self.parity is not None:
            pair = self.m > self.n
            entries[pair] = math.sqrt(0.5)
            sign = self.parity * (-1.0) ** self.j[pair]
            mirrored = self._all_numbers(self.n[pair], self.m[pair], self.j[pair])
            rows = np.concatenate([rows, mirrored])
            columns = np.concatenate([columns, columns[pair]])
            entries = np.concatenate([entries, math.sqrt(0.5) * sign])
        shape = (self.n_plane * (self.curvature + 1), len(self.m))
        return csc_array((entries, (rows, columns)), shape=shape)

    def table(self, vector: Vector) -> Vector:
        """Coefficients as an array [n_a, n_b, j], zero beyond the degree."""
        side = self.degree + 1
        result = np.zeros((side, side, self.curvature + 1), np.complex128)
        whole = self.folding @ vector
        result[self._m, self._n] = whole.reshape(self.n_plane, -1)
        # Real functions of the odd sector are i times real combinations.
        return -1j * result if self.parity == -1 else result

    def _plane_numbers(self, m: Integers, n: Integers) -> Integers:
        numbers: Integers = (m + n) * (m + n + 1) // 2 + m
        return numbers

    def _all_numbers(self, m: Integers, n: Integers, j: Integers) -> Integers:
        numbers: Integers = self._plane_numbers(m, n) * (self.curvature + 1) + j
        return numbers
