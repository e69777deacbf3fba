"""Ŝ(k) of one truncation in its two forms, for long waves and for short ones."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from fpsolve._support.arrays import Array, Complex
from fpsolve.spectral.resolvent.basis import Integers
from fpsolve.spectral.resolvent.bordered import Bordered, Plain
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
    "summed",
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
    solver : Plain or Bordered
    row, wave : ndarray
    """

    place: int
    states: Integers
    solver: Plain | Bordered
    row: Complex
    wave: Complex


def along_long_waves(generator: Generator, k1: float, k2: Sequence[float]) -> Array:
    """Ŝ = 2 Re E e^{−ik·ξ} (i k1 v − L)⁻¹ (e^{ik·ξ} − φ), φ = E e^{ik·ξ}."""
    return summed(long_wave_halves(generator, k1, k2), len(k2))


def summed(halves: Iterable[Half], n_waves: int) -> Array:
    """2 Re row·u of both parities at each of the wave vectors."""
    spectrum = np.zeros(n_waves)
    for half in halves:
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
        solver = Plain.of(shift - inner)
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
        return ShortWave(Plain.of(operator), right)
    right -= characteristic(generator, k) * null
    row = multiplied(generator, opposite)
    return ShortWave(Bordered.of(operator, null, row), right)


@dataclass(frozen=True)
class ShortWave:
    """A u = right, or A u + μ null = right with row·u = 0.

    The second is unique although A null ≈ 0 ≈ row A.

    Attributes
    ----------
    solver : Plain or Bordered
    right : ndarray
    """

    solver: Plain | Bordered
    right: Complex

    @property
    def bordered(self) -> bool:
        """Whether a null function is taken out."""
        return isinstance(self.solver, Bordered)

    def solution(self) -> Complex:
        """Its solution u."""
        return self.solver.solve(self.right)

    def adjoint(self, functional: Array) -> tuple[Complex, complex]:
        """(λ, ν) with functional·u = λ·right for every right: Aᵀλ + ν row = functional.

        Without a null function ν is zero, else null·λ = 0.
        """
        return self.solver.adjoint(functional)


def solver_of(operator: Any) -> Any:
    """Its sparse LU factors."""
    return splu(operator.tocsc())
