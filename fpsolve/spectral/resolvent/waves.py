"""Ŝ(k) of one truncation in its two forms, for long waves and for short ones."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from fpsolve._support.arrays import Array, Complex
from fpsolve.spectral.resolvent.basis import Integers
from fpsolve.spectral.resolvent.generator import Generator
from fpsolve.spectral.resolvent.plane_waves import (
    WaveVector,
    characteristic,
    multiplied,
    plane_wave,
)

__all__ = [
    "Half",
    "ShortWave",
    "along_long_waves",
    "along_short_waves",
    "long_wave_halves",
    "short_wave_equation",
]

# Share of e^{−ik·ξ} in the truncation above which it is taken out.
RESOLVED = 0.5


class Half(NamedTuple):
    """The equation of the states of one parity: A u = wave, of which row·u counts.

    Attributes
    ----------
    place : int
        Of the wave vector.
    states : ndarray of int
        Places in the basis.
    solver
        Sparse LU factors of A.
    row, wave : ndarray
    """

    place: int
    states: Integers
    solver: Any
    row: Complex
    wave: Complex


def along_long_waves(generator: Generator, k1: float, k2: Sequence[float]) -> Array:
    """Ŝ = 2 Re E e^{−ik·ξ} (i k1 v − L)⁻¹ (e^{ik·ξ} − φ), φ = E e^{ik·ξ}."""
    spectrum = np.zeros(len(k2))
    for half in long_wave_halves(generator, k1, k2):
        spectrum[half.place] += 2 * (half.row @ half.solver.solve(half.wave)).real
    return spectrum


def long_wave_halves(
    generator: Generator, k1: float, k2: Sequence[float]
) -> Iterator[Half]:
    """The equations of long waves, one factorisation and parity for every k2.

    Without φ, which makes the coherent line at k1 = 0, the constant is never asked for:
    it is left out of the matrix, and E in the stationary law out of the functional.
    """
    phis = [characteristic(generator, (k1, one)) for one in k2]
    rows = [
        multiplied(generator, (k1, one)) - phi.conjugate() * generator.stationary
        for one, phi in zip(k2, phis, strict=True)
    ]
    waves = [plane_wave(generator, (k1, one)) for one in k2]
    for sign in (1, -1):
        states = generator.basis.parity(sign)
        inner = generator.matrix[states][:, states]
        shift = 1j * k1 * generator.speed * sparse.eye_array(states.size)
        solver = solver_of(shift - inner)
        for place, (row, wave) in enumerate(zip(rows, waves, strict=True)):
            yield Half(place, states, solver, row[states], wave[states])


def along_short_waves(generator: Generator, k: WaveVector) -> float:
    """Ŝ = 2 Re E u, −(L + ik·τ) u = 1 − φ e^{−ik·ξ}: few polynomials suffice."""
    u = short_wave_equation(generator, k).solution()
    return float(2 * (generator.stationary @ u).real)


def short_wave_equation(generator: Generator, k: WaveVector) -> ShortWave:
    """The equation of a short wave, with or without a null function.

    The operator is e^{−ik·ξ} (i k1 v − L) e^{ik·ξ}: where k1 v = 0 and the truncation
    holds e^{−ik·ξ}, that is its null function, and u is the solution without it.
    """
    cosine, sine = generator.directions
    operator = -generator.matrix - 1j * (k[0] * cosine + k[1] * sine)
    right = np.zeros(generator.basis.size, complex)
    right[0] = 1.0
    opposite = -k[0], -k[1]
    null = plane_wave(generator, opposite)
    if not np.vdot(null, null).real > RESOLVED:
        return ShortWave(solver_of(operator), right)
    right -= characteristic(generator, k) * null
    row = multiplied(generator, opposite)
    return ShortWave.without(operator, null, row, right)


@dataclass(frozen=True)
class Border:
    """A null function that is taken out of an equation, and what lifts it.

    Attributes
    ----------
    null, row : ndarray
    lifted : (int, int)
        Row and column of the number that is added to the matrix.
    lift : float
        The number.
    """

    null: Complex
    row: Complex
    lifted: tuple[int, int]
    lift: float


@dataclass(frozen=True)
class ShortWave:
    """A u = right, or A u + μ null = right with row·u = 0.

    The second is unique although A null ≈ 0 ≈ row A. A bordered matrix would be dense
    after elimination. One number, added to A where it lifts the singularity, leaves it
    sparse: A = B − λ eᵢ eⱼᵀ, and with uⱼ as another unknown beside μ all follows from
    three solutions with B.

    Attributes
    ----------
    solver
        Sparse LU factors of A or B.
    right : ndarray
    border : Border or None
    """

    solver: Any
    right: Complex
    border: Border | None = None

    @classmethod
    def without(
        cls, operator: Any, null: Complex, row: Complex, right: Complex
    ) -> ShortWave:
        """The equation without a null function."""
        i, j = int(np.abs(row).argmax()), int(np.abs(null).argmax())
        lift = float(np.abs(operator.diagonal()).max())
        single = sparse.csr_array(([lift], ([i], [j])), shape=operator.shape)
        border = Border(null, row, (i, j), lift)
        return cls(solver_of(operator + single), right, border)

    def solution(self) -> Complex:
        """Its solution u."""
        if self.border is None:
            return np.asarray(self.solver.solve(self.right))
        null, row, (i, j) = self.border.null, self.border.row, self.border.lifted
        return self._bordered(self.right, null, row, i, j, "N")[0]

    def adjoint(self, functional: Array) -> tuple[Complex, complex]:
        """(λ, ν) with functional·u = λ·right for every right: Aᵀλ + ν row = functional.

        Without a border ν is zero, else null·λ = 0.
        """
        right = functional.astype(complex)
        if self.border is None:
            return np.asarray(self.solver.solve(right, trans="T")), 0j
        null, row, (i, j) = self.border.null, self.border.row, self.border.lifted
        return self._bordered(right, row, null, j, i, "T")

    def _bordered(
        self, right: Complex, column: Complex, row: Complex, i: int, j: int, trans: str
    ) -> tuple[Complex, complex]:
        """u and μ of A u + μ column = right, row·u = 0, or of the transposed A."""
        assert self.border is not None
        unit = np.zeros_like(right)
        unit[i] = self.border.lift
        columns = np.stack([right, unit, column], axis=1)
        plain, lifted, along = self.solver.solve(columns, trans=trans).T
        small = np.array([[lifted[j] - 1.0, -along[j]], [row @ lifted, -(row @ along)]])
        at, mu = np.linalg.solve(small, [-plain[j], -(row @ plain)])
        return np.asarray(plain + at * lifted - mu * along), complex(mu)


def solver_of(operator: Any) -> Any:
    """Its sparse LU factors."""
    return splu(operator.tocsc())
