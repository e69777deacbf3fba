"""Hermite polynomials about a centre times harmonics, sorted by degree."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from fpsolve._support.arrays import Array

__all__ = ["Basis", "Integers"]

Integers = NDArray[np.int64]
# From one truncation to the next; degrees are what lacks.
DEGREES, HARMONICS = 1.4, 1.25


@dataclass(frozen=True)
class Basis:
    """he_m(x1) he_n(x2) {1, √2 cos kα, √2 sin kα}, m + n <= degree, x = (ξ − c)/σ.

    The harmonics of a degree end on a quarter of an ellipse, k <= `harmonics` at degree
    0 and at least 1 at the last; every degree couples to its neighbours only.

    Attributes
    ----------
    degree, harmonics : int
    """

    degree: int
    harmonics: int

    @cached_property
    def planes(self) -> tuple[Integers, Integers]:
        """(m, n) of every product of Hermite polynomials, by degree, then n."""
        degrees = np.arange(self.degree + 1)
        n = np.concatenate([np.arange(d + 1) for d in degrees])
        return np.repeat(degrees, degrees + 1) - n, n

    @cached_property
    def circle(self) -> tuple[Integers, NDArray[np.bool_]]:
        """k of every harmonic 1, cos α, sin α, cos 2α …, and whether it is a cosine."""
        place = np.arange(2 * self.harmonics + 1)
        return (place + 1) // 2, (place % 2 == 1) | (place == 0)

    @cached_property
    def kept(self) -> Integers:
        """Of all products of planes and harmonics the places of the states."""
        m, n = self.planes
        height = np.sqrt(1.0 - ((m + n) / (self.degree + 1)) ** 2)
        last = np.maximum(1, np.rint(self.harmonics * height))
        return np.flatnonzero(self.circle[0] <= last[:, None])

    @cached_property
    def states(self) -> tuple[Integers, Integers, Integers]:
        """(m, n, harmonic) of every state, the last as a place in `circle`."""
        plane, harmonic = np.divmod(self.kept, 2 * self.harmonics + 1)
        m, n = self.planes
        return m[plane], n[plane], harmonic

    @cached_property
    def without_angle(self) -> Integers:
        """Places of the states that do not depend on α."""
        return np.flatnonzero(self.states[2] == 0)

    @property
    def size(self) -> int:
        """Number of states."""
        return self.kept.size

    def grown(self, level: int) -> Basis:
        """The basis that is `level` steps larger."""
        return Basis(
            round(self.degree * DEGREES**level),
            round(self.harmonics * HARMONICS**level),
        )

    def parity(self, sign: int) -> Integers:
        """Places that (ξ2, α) → −(ξ2, α) multiplies by `sign`, without the constant."""
        _, n, harmonic = self.states
        signs = (-1) ** n * np.where(self.circle[1][harmonic], 1, -1)
        return np.flatnonzero((signs == sign) & (np.arange(self.size) > 0))

    def product(
        self, plane: sparse.csr_array, circle: sparse.csr_array
    ) -> sparse.csr_array:
        """A matrix of the planes times one of the harmonics, between the states."""
        return sparse.kron(plane, circle, "csr")[self.kept][:, self.kept]

    def lowering(self, axis: int) -> sparse.csr_array:
        """he_m → √m he_{m−1} in x1 (`axis` 0) or in x2 (1), between the planes."""
        degree = self.planes[0] + self.planes[1]
        # Within a degree by n: lowering m keeps n, lowering n takes one off.
        before = degree * (degree - 1) // 2 + self.planes[1] - axis
        found = np.flatnonzero(self.planes[axis] > 0)
        values, shape = np.sqrt(self.planes[axis][found]), (degree.size, degree.size)
        return sparse.csr_array((values, (before[found], found)), shape=shape)

    def turned(self) -> tuple[sparse.csr_array, sparse.csr_array, sparse.csr_array]:
        """Multiplication by cos α, by sin α, and ∂_α, between the harmonics."""
        last = self.harmonics
        k, cosine = self.circle
        orders = np.arange(-last, last + 1)
        # Of every real harmonic its coefficients of e^{imα}.
        phase = np.where(cosine, 1.0, -1j * np.sign(orders)[:, None])
        waves = (np.abs(orders)[:, None] == k) * phase * np.where(k, np.sqrt(0.5), 1.0)
        step = np.eye(2 * last + 1, k=-1)
        images = (0.5 * (step + step.T), -0.5j * (step - step.T), np.diag(1j * orders))
        return tuple(_sparse((waves.conj().T @ image @ waves).real) for image in images)


def _sparse(matrix: Array) -> sparse.csr_array:
    """Without what rounding leaves of zeros."""
    return sparse.csr_array(np.where(np.abs(matrix) > 1e-12, matrix, 0.0))
