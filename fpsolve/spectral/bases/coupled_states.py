"""Basis functions of many angular indices M, folded by reflection."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

import numpy as np
from scipy.sparse import csc_array

from fpsolve.spectral.bases.body_states import BodyStates
from fpsolve.spectral.bases.sectors import Integers, Sector, Truncation, Vector

__all__ = ["CoupledStates", "indices"]


def indices(sector: Sector, largest: int) -> Integers:
    """The M >= 0 of a sector up to the largest.

    The two reflections together turn the plane by π: M is even in a sector where both
    parities agree, and odd where they differ.
    """
    if sector.M is not None or sector.parity is None:
        raise ValueError(f"`sector` must have a parity and no M, got {sector!r}.")
    every = np.arange(largest + 1)
    if sector.parity_along is None:
        return every
    odd = sector.parity != sector.parity_along
    kept: Integers = every[every % 2 == odd]
    return kept


class CoupledStates:
    """All states (M, n_a, n_b, j) of a sector, by M.

    A state of M > 0 stands for the pair
    (|M, n_a, n_b, j⟩ ± (-1)^j |-M, n_b, n_a, j⟩)/√2 of one parity under
    (ξ2, α, κ) → -(ξ2, α, κ); the states of M = 0 are those of `BodyStates` of that
    parity.

    Attributes
    ----------
    M : ndarray of int
        The angular indices.
    parts : list of BodyStates
        The states of each.
    plain : BodyStates
        The states of any M, not folded.
    offsets : ndarray of int
        Where the states of an index begin in a vector, and the size.
    parity : int
    """

    def __init__(self, sector: Sector, truncation: Truncation) -> None:
        self.M = indices(sector, truncation.harmonics)
        self.parity: int = sector.parity or 1
        self.plain = BodyStates(Sector(1), truncation)
        folded = BodyStates(Sector(0, self.parity), truncation)
        self.parts = [self.plain if index else folded for index in self.M]
        self.offsets = np.cumsum([0, *(len(part.m) for part in self.parts)])

    @property
    def size(self) -> int:
        """Number of states."""
        return int(self.offsets[-1])

    def slices(self) -> Iterator[tuple[int, slice]]:
        """Every M with its part of a vector."""
        ends = zip(self.offsets[:-1], self.offsets[1:], strict=True)
        for index, (start, stop) in zip(self.M, ends, strict=True):
            yield int(index), slice(int(start), int(stop))

    @property
    def harmonics(self) -> Integers:
        """The harmonic k = M - l of every state."""
        pairs = zip(self.M, self.parts, strict=True)
        return np.concatenate([index - part.angular for index, part in pairs])

    @cached_property
    def mirror(self) -> csc_array:
        """(n_a, n_b, j) → ±(-1)^j (n_b, n_a, j) on plain states, ± the parity."""
        part = self.plain
        rows = part.numbers(part.n, part.m, part.j)
        entries = self.parity * (-1.0) ** part.j
        size = len(part.m)
        return csc_array((entries, (rows, np.arange(size))), shape=(size, size))

    @cached_property
    def folding(self) -> csc_array:
        """Vectors of M = 0 of the parity, in plain states."""
        return self.parts[0].folding if self.M[0] == 0 else self.plain.folding

    def signed(self, vector: Vector) -> Iterator[tuple[int, Vector]]:
        """Every M of both signs with its coefficients of plain states."""
        for index, part in self.slices():
            if index == 0:
                yield 0, self.folding @ vector[part]
                continue
            half = np.sqrt(0.5) * vector[part]
            yield index, half
            yield -index, self.mirror @ half

    def table(self, plain: Vector) -> Vector:
        """Plain coefficients as an array [n_a, n_b, j]."""
        part = self.plain
        side = part.degree + 1
        result = np.zeros((side, side, part.curvature + 1), np.complex128)
        result[part.m, part.n, part.j] = plain
        # Real functions of the odd sector are i times real combinations.
        return -1j * result if self.parity == -1 else result
