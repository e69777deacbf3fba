"""Derivatives of Ŝ(k) of a smooth fibre in its parameters, by adjoint solutions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fpsolve._support.arrays import Array, Complex
from fpsolve.spectral.resolvent.plane_waves import WaveVector
from fpsolve.spectral.resolvent.sensitivity import of_operator
from fpsolve.spectral.resolvent.smooth_generator import SmoothGenerator
from fpsolve.spectral.resolvent.smooth_solutions import (
    ByDegree,
    long_wave_halves,
    short_wave,
)
from fpsolve.spectral.resolvent.smooth_waves import multiplied, plane_wave

__all__ = ["smooth_long_columns", "smooth_short_columns"]

# Of the adjoint solution for the second law, what is left of the difference between
# laws, which is itself a thousandth or less.
OF_DIFFERENCE = 1e-3


def smooth_long_columns(
    generator: SmoothGenerator, k1: float, k2: Sequence[float]
) -> Array:
    """Ŝ and its derivatives at one k1 and many k2, (k2, 1 + parameter).

    Ŝ = 2 Re row·u, A u + μ 1 = wave − φ and p·u = 0 with A = i k1 v − L, where p is the
    stationary law. With the same factors Aᵀλ + ν p = row, λ·1 = 0:

        ∂Ŝ = 2 Re [∂row·u − λ·∂A u − ν ∂p·u],   ∂row = ∂p e^{−ik·ξ} − ∂φ̄ p − φ̄ ∂p.

    Of φ on the right λ sees nothing.
    """
    shape = len(k2), generator.basis.size
    values, of_law = np.zeros(len(k2)), np.zeros(len(k2), complex)
    solutions, adjoints = np.zeros((2, *shape), complex)
    for half in long_wave_halves(generator, k1, k2):
        u = half.solver.solve(half.wave)
        values[half.place] += 2 * (half.row @ u).real
        adjoint, nu = half.solver.adjoint(half.row)
        solutions[half.place, half.states] = u
        adjoints[half.place, half.states] = adjoint
        of_law[half.place] += nu
    columns = np.empty((len(k2), 1 + len(generator.parameters)))
    columns[:, 0] = values
    for place, (u, adjoint) in enumerate(zip(solutions, adjoints, strict=True)):
        change = of_operator(generator.derivatives, adjoint, u)
        change += of_row(generator, (k1, k2[place]), u)
        change -= of_law[place] * (generator.stationary_derivatives @ u)
        # Of i k1 v, the rest of A.
        change[generator.parameters.index("belt_speed")] -= 1j * k1 * (adjoint @ u)
        columns[place, 1:] = 2 * np.real(change)
    return columns


def of_row(generator: SmoothGenerator, k: WaveVector, u: Complex) -> Complex:
    """∂row·u in every parameter: e^{−ik·ξ} u is found once, by a symmetric matrix."""
    wave, changes = plane_wave(generator, k), generator.stationary_derivatives
    phi = (generator.stationary @ wave).conjugate()
    lost = (changes @ wave).conjugate() * (generator.stationary @ u)
    return np.asarray(changes @ (multiplied(generator, u, k) - phi * u) - lost)


def smooth_short_columns(
    generator: SmoothGenerator,
    laws: Sequence[Array],
    changes: Sequence[Array],
    k: WaveVector,
) -> Array:
    """Ŝ and its derivatives at one k by each of the laws, (law, 1 + parameter).

    Ŝ = 2 Re g·u, A u = 1 − φ null, with g = p − (p·null) row, null = e^{−ik·ξ} and
    row = p e^{ik·ξ}: g does not see what u has of the null function. With Aᵀλ = g,

        ∂Ŝ = 2 Re [∂g·u + λ·(∂L u − ∂φ null)],
        ∂g = ∂p − (∂p·null) row − (p·null) ∂row,

    which is that of the truncation, whatever it has of the null function.

    Parameters
    ----------
    generator : SmoothGenerator
    laws, changes : sequence of ndarray
        Stationary laws of larger truncations, and their derivatives, (parameter, …).
    k : (float, float)
    """
    opposite = -k[0], -k[1]
    solver, known, u = short_wave(generator, laws[0], k)
    null = np.zeros(u.size, complex) if known is None else known
    rows = [multiplied(generator, law, opposite) for law in laws]
    functionals: list[Complex] = [
        law - (law @ null) * row for law, row in zip(laws, rows, strict=True)
    ]
    adjoints = adjoints_of(solver, functionals)
    turned = multiplied(generator, u, opposite)
    columns = np.empty((len(laws), 1 + len(generator.parameters)))
    for place, (law, row) in enumerate(zip(laws, rows, strict=True)):
        seen = u - (row @ u) * null - (law @ null) * turned
        of_right = (changes[0] @ null).conjugate() * (adjoints[place] @ null)
        of_left = of_operator(generator.derivatives, adjoints[place], u)
        change = changes[place] @ seen + of_left - of_right
        columns[place, 0] = 2 * (functionals[place] @ u).real
        columns[place, 1:] = 2 * change.real
    return columns


def adjoints_of(solver: ByDegree, functionals: Sequence[Complex]) -> list[Complex]:
    """Of nearly equal functionals: the first, and differences to fewer digits."""
    first, *others = functionals
    found = [solver.solve(first, "T")]
    for other in others:
        difference = other - first
        if np.any(difference):
            solution = solver.solve(difference, "T", OF_DIFFERENCE)
            found.append(found[0] + solution)
        else:
            found.append(found[0])
    return found
