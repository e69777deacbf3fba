"""Functions of where a smooth fibre lies, of its angle and of its curvature."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from scipy import sparse

from fpsolve.spectral.resolvent.basis import Basis, Integers

__all__ = ["SmoothBasis", "States"]

# From one truncation to the next, in all three directions; as many states as 2.2 times.
GROWTH = 1.22


class States(NamedTuple):
    """Of every state the degrees of its polynomials, and its harmonic.

    Attributes
    ----------
    along, across : ndarray of int
        In x1 and x2.
    harmonic : ndarray of int
        A place in `Basis.circle`.
    curvature : ndarray of int
        In κ.
    """

    along: Integers
    across: Integers
    harmonic: Integers
    curvature: Integers


@dataclass(frozen=True)
class SmoothBasis:
    """he_m(x1) he_n(x2) {1, √2 cos kα, √2 sin kα} he_j(κ/g) in an eighth of a ball.

    Of (m + n)/(degree + 1), k/(harmonics + 1) and j/(curvature + 1) the sum of squares
    is below one, for j = 0 that with j = 1. The Gaussians that belong to the
    polynomials are those of a `Placement`.

    Attributes
    ----------
    degree, harmonics, curvature : int
    """

    degree: int
    harmonics: int
    curvature: int

    @cached_property
    def flat(self) -> Basis:
        """Of positions and angle, with all of their products."""
        return Basis(self.degree, self.harmonics)

    @cached_property
    def kept(self) -> Integers:
        """Of all products the places of the states, by position first."""
        m, n = self.flat.planes
        # L damps nothing of j = 0 but by way of j = 1: alone it is nearly null, which
        # solutions hardly see, but their derivatives do.
        damped = np.maximum(np.arange(self.curvature + 1), 1)
        parts = (
            (m + n)[:, None, None] / (self.degree + 1),
            self.flat.circle[0][:, None] / (self.harmonics + 1),
            damped / (self.curvature + 1),
        )
        return np.flatnonzero(sum(part**2 for part in parts) < 1.0)

    @cached_property
    def states(self) -> States:
        """The states in the order of `kept`."""
        shape = 2 * self.harmonics + 1, self.curvature + 1
        plane, rest = np.divmod(self.kept, shape[0] * shape[1])
        harmonic, j = np.divmod(rest, shape[1])
        m, n = self.flat.planes
        return States(m[plane], n[plane], harmonic, j)

    @cached_property
    def without_angle(self) -> Integers:
        """Places of the states that do not depend on α."""
        return np.flatnonzero(self.states.harmonic == 0)

    @property
    def size(self) -> int:
        """Number of states."""
        return self.kept.size

    def grown(self, level: int) -> SmoothBasis:
        """The basis that is `level` steps larger."""
        sizes = (self.degree, self.harmonics, self.curvature)
        return SmoothBasis(*(round(size * GROWTH**level) for size in sizes))

    def parity(self, sign: int) -> Integers:
        """Places of what (ξ2, α, κ) → −(ξ2, α, κ) multiplies by `sign`."""
        states = self.states
        turned = np.where(self.flat.circle[1][states.harmonic], 1, -1)
        signs = (-1) ** (states.across + states.curvature) * turned
        return np.flatnonzero(signs == sign)

    def product(
        self,
        plane: sparse.csr_array,
        circle: sparse.csr_array,
        curvature: sparse.csr_array,
    ) -> sparse.csr_array:
        """A matrix of the planes times one of the harmonics and one of κ."""
        both = sparse.kron(plane, circle, "csr")
        return sparse.kron(both, curvature, "csr")[self.kept][:, self.kept]

    def table(self, vector: Any) -> Any:
        """Coefficients by degree in x1, in x2, harmonic and degree in κ."""
        shape = (self.degree + 1,) * 2 + (2 * self.harmonics + 1, self.curvature + 1)
        table = np.zeros(shape, vector.dtype)
        table[tuple(self.states)] = vector
        return table

    def picked(self, table: Any) -> Any:
        """Coefficients of the states out of a table of any size, zero beyond it."""
        states = np.stack(self.states)
        within = (states < np.array(table.shape)[:, None]).all(axis=0)
        vector = np.zeros(self.size, table.dtype)
        vector[within] = table[tuple(states[:, within])]
        return vector

    def degrees(self) -> list[tuple[slice, int]]:
        """Of every degree in ξ where its states lie, and how many products of x."""
        degree = self.states.along + self.states.across
        ends = np.searchsorted(degree, np.arange(self.degree + 2))
        return [
            (slice(int(begin), int(end)), d + 1)
            for d, (begin, end) in enumerate(pairwise(ends))
        ]
