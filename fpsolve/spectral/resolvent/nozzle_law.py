"""The time-periodic law of a fibre under a moving nozzle, in one truncation."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, gmres, splu

from fpsolve._support.arrays import Array, Complex
from fpsolve.errors import ToleranceError
from fpsolve.spectral.resolvent.nozzle_generator import NozzleGenerator

__all__ = ["NozzleLaw"]

# Relative residual that is left, and vectors and rounds of the iteration.
RESIDUAL, VECTORS, ROUNDS = 1e-9, 80, 4


@dataclass(frozen=True, eq=False)
class NozzleLaw:
    """g(s) = Σ_j g_j e^{ijωs} with dg/ds = g L(s): E of every state over a period.

    (L0ᵀ − ijω) g_j + Rᵀ g_{j−1} + R̄ᵀ g_{j+1} = 0, j = 0 … n, with g_{−j} = ḡ_j and
    the constant 1 in g_0: GMRES on all harmonics, preconditioned by the factors of
    each, which the motion of the nozzle couples.

    Attributes
    ----------
    generator : NozzleGenerator
    """

    generator: NozzleGenerator

    @cached_property
    def harmonics(self) -> Complex:
        """g_j, shape (n + 1, state).

        Raises
        ------
        ToleranceError
            If the iteration does not end: the nozzle moves too fast.
        """
        right = self._solved(self._sources)
        size = right.size

        def applied(parts: Array) -> Array:
            g = (parts[:size] + 1j * parts[size:]).reshape(right.shape)
            return real_of(g + self._solved(self._coupled(g)))

        operator = LinearOperator((2 * size, 2 * size), matvec=applied, dtype=float)
        found, left = gmres(
            operator, real_of(right), rtol=RESIDUAL, restart=VECTORS, maxiter=ROUNDS
        )
        if left:
            reached = np.linalg.norm(applied(found) - real_of(right))
            raise ToleranceError(
                float(reached / np.linalg.norm(right)), RESIDUAL,
                "let the nozzle move less, or more slowly, or raise the noise",
            )  # fmt: skip
        g = np.zeros((right.shape[0], right.shape[1] + 1), np.complex128)
        g[:, 1:] = (found[:size] + 1j * found[size:]).reshape(right.shape)
        g[0, 0] = 1.0
        return g

    def mean(self) -> tuple[Complex, Complex]:
        """E x1 and E x2 in units of σ: their harmonics, shape (n + 1,)."""
        m, n, harmonic = self.generator.basis.plain.states
        plain = harmonic == 0
        first, second = (
            self.harmonics[:, np.flatnonzero(plain & (m == one) & (n == 1 - one))[0]]
            for one in (1, 0)
        )
        return first, second

    @cached_property
    def _factors(self) -> list[Any]:
        """Of L0 − ijω without the constant."""
        inner = self.generator.plain.matrix[1:][:, 1:]
        same = sparse.eye_array(inner.shape[0])
        omega = self.generator.frequency
        return [
            splu((inner - 1j * j * omega * same).tocsc())
            for j in range(self.generator.basis.phases + 1)
        ]

    @cached_property
    def _couplings(self) -> tuple[sparse.csr_array, sparse.csr_array]:
        """Rᵀ and R̄ᵀ without the constant."""
        rising = self.generator.rising[1:][:, 1:].T.tocsr()
        return rising, rising.conj()

    @property
    def _sources(self) -> Complex:
        """What the constant of g_0 gives to others."""
        right = np.zeros(
            (self.generator.basis.phases + 1, self.generator.basis.plain.size - 1),
            np.complex128,
        )
        right[0] = -self.generator.plain.matrix[[0]][:, 1:].toarray()[0]
        right[1] = -self.generator.rising[[0]][:, 1:].toarray()[0]
        return right

    def _solved(self, right: Complex) -> Complex:
        pairs = zip(self._factors, right, strict=True)
        return np.array([one.solve(row, trans="T") for one, row in pairs])

    def _coupled(self, g: Complex) -> Complex:
        rising, falling = self._couplings
        found = np.zeros_like(g)
        found[1:] += (rising @ g[:-1].T).T
        found[:-1] += (falling @ g[1:].T).T
        found[0] += rising @ g[1].conj()
        return found


def real_of(g: Complex) -> Array:
    """Real and imaginary parts one after the other: conjugation is linear in them."""
    flat = g.ravel()
    return np.concatenate([flat.real, flat.imag])
