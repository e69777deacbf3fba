"""Radial functions times harmonics of both angles, sorted by degree."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

from fpsolve.spectral.resolvent.basis import Basis, Integers

__all__ = ["RoundBasis"]


@dataclass(frozen=True)
class RoundBasis(Basis):
    """g_j^|l|(r) {1, √2 cos(lφ + kα), √2 sin(lφ + kα)}, l = m − n, j = min(m, n).

    As many functions of a degree 2j + |l| = m + n as there are products of Hermite
    polynomials, and the same harmonics of each. Of the waves e^{i(lφ + kα)} and
    e^{−i(lφ + kα)} the first, k > 0 or k = 0 < l, has the place of the cosine, the
    second that of the sine.
    """

    @cached_property
    def orders(self) -> tuple[Integers, Integers]:
        """(l, k) of every wave."""
        m, n, harmonic = self.states
        k, cosine = self.circle
        return m - n, np.where(cosine, k, -k)[harmonic]

    @cached_property
    def mirrored(self) -> Integers:
        """Place of e^{−i(lφ + kα)} for every wave: m and n exchanged, k reversed."""
        m, n, harmonic = self.states
        n_circle, degree = 2 * self.harmonics + 1, m + n
        opposite = np.where(harmonic == 0, 0, ((harmonic - 1) ^ 1) + 1)
        plane = degree * (degree + 1) // 2 + m
        return np.searchsorted(self.kept, plane * n_circle + opposite)

    def parity(self, sign: int) -> Integers:
        """Places that (φ, α) → −(φ, α) multiplies by `sign`, without the constant."""
        angular, k = self.orders
        first = (k > 0) | ((k == 0) & (angular >= 0))
        alone = self.mirrored == np.arange(self.size)
        # A wave that is its own mirror image is real: l = k = 0.
        found = (first | alone) if sign == 1 else ~(first | alone)
        return np.flatnonzero(found & (np.arange(self.size) > 0))

    @cached_property
    def real(self) -> sparse.csr_array:
        """Coefficients of waves, from those of cosines and sines: a unitary matrix."""
        places = np.arange(self.size)
        alone = places[self.mirrored == places]
        even = np.setdiff1d(self.parity(1), alone)
        odd = self.parity(-1)
        half = np.sqrt(0.5)
        rows = (alone, even, self.mirrored[even], self.mirrored[odd], odd)
        columns = (alone, even, even, odd, odd)
        values = (1.0, half, half, -1j * half, 1j * half)
        return sparse.csr_array(
            (
                np.repeat(values, [row.size for row in rows]),
                (np.concatenate(rows), np.concatenate(columns)),
            ),
            shape=(self.size, self.size),
        )

    def folded(self, waves: sparse.csr_array) -> sparse.csr_array:
        """A real operator between waves as one between cosines and sines."""
        return sparse.csr_array((self.real.conj().T @ waves @ self.real).real)

    def steps(self) -> tuple[sparse.csr_array, sparse.csr_array]:
        """e^{ikα} → e^{i(k+1)α}, and k e^{ikα}, between the harmonics."""
        k, cosine = self.circle
        signed = np.where(cosine, k, -k)
        up = (signed[:, None] == signed + 1).astype(float)
        return sparse.csr_array(up), sparse.csr_array(np.diag(signed.astype(float)))
