"""Ŝ(k) of a smooth fibre in one truncation, for long waves and for short ones."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, gmres, splu

from fpsolve._support.arrays import Array, Complex
from fpsolve.errors import ToleranceError
from fpsolve.spectral.resolvent.plane_waves import WaveVector
from fpsolve.spectral.resolvent.smooth_basis import SmoothBasis
from fpsolve.spectral.resolvent.smooth_generator import SmoothGenerator
from fpsolve.spectral.resolvent.smooth_waves import (
    characteristic,
    multiplied,
    plane_wave,
)

__all__ = ["along_long_waves", "along_short_waves"]

# What GMRES leaves of the residual, its vectors and how often it may begin anew.
RESIDUAL, VECTORS, RESTARTS = 1e-6, 400, 2
# A residual beyond which it has failed.
FAILED = 1e-4
# Share of e^{−ik·ξ} in the truncation below which it is none of its null functions.
NEGLIGIBLE = 1e-12
Solver = Callable[[Complex], Complex]


def along_long_waves(
    generator: SmoothGenerator, k1: float, k2: Sequence[float]
) -> Array:
    """Ŝ = 2 Re E e^{−ik·ξ} (i k1 v − L)⁻¹ (e^{ik·ξ} − φ), φ = E e^{ik·ξ}.

    One factorisation for every k2. At k1 v = 0 the constants, which a truncation only
    nearly has, are taken out.
    """
    p, spectrum = generator.stationary, np.zeros(len(k2))
    phis = [characteristic(generator, (k1, one)) for one in k2]
    pairs = list(zip(k2, phis, strict=True))
    rows = [
        multiplied(generator, p, (k1, one)) - phi.conjugate() * p for one, phi in pairs
    ]
    waves = [
        plane_wave(generator, (k1, one)) - phi * generator.one for one, phi in pairs
    ]
    for sign in (1, -1):
        states = generator.basis.parity(sign)
        shift = 1j * k1 * generator.speed * sparse.eye_array(states.size)
        operator = shift - generator.matrix[states][:, states]
        solve = _factorised(operator)
        if sign == 1:
            solve = without_constants(operator, generator.one[states], p[states])
        for place, (row, wave) in enumerate(zip(rows, waves, strict=True)):
            spectrum[place] += 2 * (row[states] @ solve(wave[states])).real
    return spectrum


def without_constants(operator: Any, one: Array, p: Array) -> Solver:
    """Of f the u with p·u = 0 and A u + μ 1 = f, unique although A 1 ≈ 0 ≈ p A.

    One number, added to A where it lifts the singularity, leaves it sparse: A = B − λ
    eᵢ eⱼᵀ, and with uⱼ as another unknown beside μ all follows from solutions with B.
    """
    i, j = int(np.abs(p).argmax()), int(np.abs(one).argmax())
    lift = float(np.abs(operator.diagonal()).max())
    single = sparse.csr_array(([lift], ([i], [j])), shape=operator.shape)
    inverse = _factorised(operator + single)
    unit = np.zeros(p.size, complex)
    unit[i] = lift
    lifted, along = inverse(unit), inverse(one.astype(complex))
    small = np.array([[lifted[j] - 1.0, -along[j]], [p @ lifted, -(p @ along)]])

    def solve(right: Complex) -> Complex:
        plain = inverse(right)
        at, mu = np.linalg.solve(small, [-plain[j], -(p @ plain)])
        return np.asarray(plain + at * lifted - mu * along)

    return solve


def along_short_waves(
    generator: SmoothGenerator, laws: Sequence[Array], k: WaveVector
) -> Array:
    """Ŝ = 2 Re E u, −(L + ik·τ) u = 1 − φ e^{−ik·ξ}, of which few polynomials suffice.

    The operator is e^{−ik·ξ} (i k1 v − L) e^{ik·ξ}: where k1 v = 0 its null function is
    e^{−ik·ξ}, and u is the solution with E e^{ik·ξ} u = 0.

    Parameters
    ----------
    generator : SmoothGenerator
    laws : sequence of ndarray
        Stationary laws of larger truncations; of each Ŝ is returned.
    k : (float, float)
    """
    cosine, sine = generator.directions
    operator = (-generator.matrix - 1j * (k[0] * cosine + k[1] * sine)).tocsr()
    opposite = -k[0], -k[1]
    null = plane_wave(generator, opposite)
    if np.vdot(null, null).real < NEGLIGIBLE:
        solution = by_degree(operator, generator.one, generator.basis)
        return np.array([2 * (law @ solution).real for law in laws])
    phi = (laws[0] @ null).conjugate()
    solution = by_degree(operator, generator.one - phi * null, generator.basis)
    found = []
    for law in laws:
        row = multiplied(generator, law, opposite)
        kept = law @ null
        found.append(2 * (law @ solution - (row @ solution) * kept).real)
    return np.array(found)


def by_degree(operator: Any, right: Any, basis: SmoothBasis) -> Complex:
    """A u = f by GMRES, preconditioned by the blocks of equal polynomials of ξ.

    Over waves much shorter than σ the place changes little until they are averaged
    out: what couples degrees is weak. A block is an equation in α and κ, the same for
    all polynomials of a degree.

    Raises
    ------
    ToleranceError
        If the iteration does not converge: the wave is not short enough.
    """
    blocks = []
    for part, n_planes in basis.degrees():
        first = slice(part.start, part.start + (part.stop - part.start) // n_planes)
        blocks.append((part, n_planes, splu(operator[first, first].tocsc())))

    def precondition(f: Complex) -> Complex:
        found = np.empty_like(f)
        for part, n_planes, factors in blocks:
            columns = f[part].reshape(n_planes, -1).T
            found[part] = factors.solve(np.ascontiguousarray(columns)).T.ravel()
        return found

    product = LinearOperator(
        operator.shape, lambda f: operator @ precondition(f), dtype=complex
    )
    inner, _ = gmres(
        product, right, rtol=RESIDUAL, atol=0.0, restart=VECTORS, maxiter=RESTARTS
    )
    solution = precondition(inner)
    defect = np.linalg.norm(operator @ solution - right) / np.linalg.norm(right)
    if not defect <= FAILED:
        raise ToleranceError(
            float(defect), FAILED,
            "of the equation for a short wave, whatever is asked of its spectrum: "
            "raise the noise, for the fibre keeps its direction over too long a way",
        )  # fmt: skip
    return np.asarray(solution)


def _factorised(operator: Any) -> Solver:
    """Solutions by its sparse LU factors."""
    factors = splu(operator.tocsc())
    return lambda right: np.asarray(factors.solve(right.astype(complex)))
