"""Derivatives of Ŝ(k) in the parameters of the model, by adjoint solutions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array, Complex
from fpsolve.spectral.resolvent.generator import Generator
from fpsolve.spectral.resolvent.plane_waves import (
    WaveVector,
    against_wave,
    plane_wave,
)
from fpsolve.spectral.resolvent.waves import long_wave_halves, short_wave_equation

__all__ = ["long_wave_columns", "of_operator", "short_wave_columns"]


def long_wave_columns(generator: Generator, k1: float, k2: Sequence[float]) -> Array:
    """Ŝ and its derivatives at one k1 and many k2, (k2, 1 + parameter).

    Ŝ = 2 Re row·u, A u = wave, A = i k1 v − L, and with the same factors Aᵀλ = row:

        ∂Ŝ = 2 Re [∂row·u − λ·∂A u],   ∂row = ∂E e^{−ik·ξ} − ∂φ̄ E − φ̄ ∂E.

    The functions of the basis are kept, so that the wave is, too.
    """
    shape = len(k2), generator.basis.size
    values, solutions, adjoints = np.zeros(len(k2)), *np.zeros((2, *shape), complex)
    for half in long_wave_halves(generator, k1, k2):
        u = half.solver.solve(half.wave)
        values[half.place] += 2 * (half.row @ u).real
        solutions[half.place, half.states] = u
        adjoints[half.place, half.states] = half.solver.adjoint(half.row)[0]
    columns = np.empty((len(k2), 1 + len(generator.parameters)))
    columns[:, 0] = values
    for place, (u, adjoint) in enumerate(zip(solutions, adjoints, strict=True)):
        k = k1, k2[place]
        change = of_operator(generator.derivatives, adjoint, u) + of_row(
            generator, k, u
        )
        # Of i k1 v, the rest of A; v is the second parameter of every generator.
        change[generator.parameters.index("belt_speed")] -= 1j * k1 * (adjoint @ u)
        columns[place, 1:] = 2 * change.real
    return columns


def of_operator(changes: Sequence[Any], adjoint: Complex, u: Complex) -> Complex:
    """λ·∂L u in every parameter, of the matrices of ∂L."""
    return np.array([adjoint @ (change @ u) for change in changes])


def of_row(generator: Generator, k: WaveVector, u: Complex) -> Complex:
    """∂row·u in every parameter: e^{−ik·ξ} u is found once, by a symmetric matrix."""
    wave, changes = plane_wave(generator, k), generator.stationary_derivatives
    phi = (generator.stationary @ wave).conjugate()
    lost = (changes @ wave).conjugate() * (generator.stationary @ u)
    return np.asarray(changes @ (against_wave(generator, k, u) - phi * u) - lost)


def short_wave_columns(generator: Generator, k: WaveVector) -> Array:
    """Ŝ and its derivatives at one k, (1 + parameter,).

    Ŝ = 2 Re g·u, A u + μ null = 1 − φ null, row·u = 0, A = −(L + ik·τ), and with the
    same factors Aᵀλ + ν row = g, null·λ = 0:

        ∂Ŝ = 2 Re [∂g·u + λ·∂L u − ν ∂row·u].

    The null function is kept and λ does not see it; where the truncation has none,
    ν = 0.
    """
    equation = short_wave_equation(generator, k)
    u = equation.solution()
    adjoint, nu = equation.adjoint(generator.stationary)
    changes = generator.stationary_derivatives
    change = changes @ u + of_operator(generator.derivatives, adjoint, u)
    if equation.bordered:
        change -= nu * (changes @ against_wave(generator, (-k[0], -k[1]), u))
    value = 2 * (generator.stationary @ u).real
    return np.array([value, *2 * change.real])
