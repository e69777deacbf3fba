"""Ŝ(k) of one truncation in its two forms, for long waves and for short ones."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from fpsolve._support.arrays import Array, Complex
from fpsolve.spectral.resolvent.generator import Generator
from fpsolve.spectral.resolvent.plane_waves import (
    WaveVector,
    characteristic,
    multiplied,
    plane_wave,
)

__all__ = ["along_long_waves", "along_short_waves"]

# Share of e^{−ik·ξ} in the truncation above which it is taken out.
RESOLVED = 0.5


def along_long_waves(generator: Generator, k1: float, k2: Sequence[float]) -> Array:
    """Ŝ = 2 Re E e^{−ik·ξ} (i k1 v − L)⁻¹ (e^{ik·ξ} − φ), φ = E e^{ik·ξ}.

    One factorisation for every k2. Without φ, which makes the coherent line at k1 = 0,
    the constant is never asked for: it is left out of the matrix, and E in the
    stationary law out of the functional.
    """
    spectrum = np.zeros(len(k2))
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
            spectrum[place] += 2 * (row[states] @ solver.solve(wave[states])).real
    return spectrum


def along_short_waves(generator: Generator, k: WaveVector) -> float:
    """Ŝ = 2 Re E u, −(L + ik·τ) u = 1 − φ e^{−ik·ξ}, of which few polynomials suffice.

    The operator is e^{−ik·ξ} (i k1 v − L) e^{ik·ξ}: where k1 v = 0 and the truncation
    holds e^{−ik·ξ}, that is its null function, and u is the solution without it.
    """
    cosine, sine = generator.directions
    operator = -generator.matrix - 1j * (k[0] * cosine + k[1] * sine)
    right = np.zeros(generator.basis.size, complex)
    right[0] = 1.0
    opposite = -k[0], -k[1]
    null = plane_wave(generator, opposite)
    if np.vdot(null, null).real > RESOLVED:
        right -= characteristic(generator, k) * null
        solution = without(operator, null, multiplied(generator, opposite), right)
    else:
        solution = solver_of(operator).solve(right)
    return float(2 * (generator.stationary @ solution).real)


def without(operator: Any, null: Complex, row: Complex, right: Complex) -> Complex:
    """u with row·u = 0 and A u + μ null = right: unique although A null ≈ 0 ≈ row A.

    A bordered matrix would be dense after elimination. One number, added to A where it
    lifts the singularity, leaves it sparse: A = B − λ eᵢ eⱼᵀ, and with uⱼ as another
    unknown beside μ all follows from three solutions with B.
    """
    i, j = int(np.abs(row).argmax()), int(np.abs(null).argmax())
    lift = float(np.abs(operator.diagonal()).max())
    single = sparse.csr_array(([lift], ([i], [j])), shape=operator.shape)
    unit = np.zeros_like(right)
    unit[i] = lift
    solved = solver_of(operator + single).solve(np.stack([right, unit, null], axis=1))
    plain, lifted, along = solved.T
    small = np.array([[lifted[j] - 1.0, -along[j]], [row @ lifted, -(row @ along)]])
    at, mu = np.linalg.solve(small, [-plain[j], -(row @ plain)])
    return np.asarray(plain + at * lifted - mu * along)


def solver_of(operator: Any) -> Any:
    """Its sparse LU factors."""
    return splu(operator.tocsc())
