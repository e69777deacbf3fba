"""Ŝ(k) of a smooth fibre in one truncation, for long waves and for short ones."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, Literal, NamedTuple

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, gmres, splu

from fpsolve._support.arrays import Array, Complex
from fpsolve.errors import ToleranceError
from fpsolve.spectral.resolvent.bordered import Bordered, Plain
from fpsolve.spectral.resolvent.plane_waves import WaveVector
from fpsolve.spectral.resolvent.smooth_basis import SmoothBasis
from fpsolve.spectral.resolvent.smooth_generator import SmoothGenerator
from fpsolve.spectral.resolvent.smooth_waves import (
    characteristic,
    multiplied,
    plane_wave,
)
from fpsolve.spectral.resolvent.waves import Half, summed

__all__ = [
    "ByDegree",
    "ShortWave",
    "along_long_waves",
    "along_short_waves",
    "long_wave_halves",
    "short_wave",
]

# What GMRES leaves of the residual, its vectors and how often it may begin anew.
RESIDUAL, VECTORS, RESTARTS = 1e-6, 400, 2
# So many times that residual, it has failed.
FAILED = 100.0
# Share of e^{−ik·ξ} in the truncation below which it is none of its null functions.
NEGLIGIBLE = 1e-12


def along_long_waves(
    generator: SmoothGenerator, k1: float, k2: Sequence[float]
) -> Array:
    """Ŝ = 2 Re E e^{−ik·ξ} (i k1 v − L)⁻¹ (e^{ik·ξ} − φ), φ = E e^{ik·ξ}."""
    return summed(long_wave_halves(generator, k1, k2), len(k2))


def long_wave_halves(
    generator: SmoothGenerator, k1: float, k2: Sequence[float]
) -> Iterator[Half]:
    """The equations of long waves, one factorisation and parity for every k2.

    At k1 v = 0 the constants, which a truncation only nearly has, are taken out.
    """
    p = generator.stationary
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
        solver: Plain | Bordered
        if sign == 1:
            solver = Bordered.of(operator, generator.one[states], p[states])
        else:
            solver = Plain.of(operator)
        for place, (row, wave) in enumerate(zip(rows, waves, strict=True)):
            yield Half(place, states, solver, row[states], wave[states])


class ShortWave(NamedTuple):
    """A u = 1 − φ e^{−ik·ξ}, A = −(L + ik·τ), of which few polynomials suffice.

    The operator is e^{−ik·ξ} (i k1 v − L) e^{ik·ξ}: where k1 v = 0 its null function is
    e^{−ik·ξ}, and what counts of u is u − (E e^{ik·ξ} u) e^{−ik·ξ}.

    Attributes
    ----------
    solver : ByDegree
        Of A.
    null : ndarray or None
        e^{−ik·ξ}; None where the truncation has nothing of it.
    solution : ndarray
        u.
    """

    solver: ByDegree
    null: Complex | None
    solution: Complex


def short_wave(generator: SmoothGenerator, law: Array, k: WaveVector) -> ShortWave:
    """The equation with φ in a law, solved."""
    cosine, sine = generator.directions
    operator = (-generator.matrix - 1j * (k[0] * cosine + k[1] * sine)).tocsr()
    solver = ByDegree(operator, generator.basis)
    null = plane_wave(generator, (-k[0], -k[1]))
    if np.vdot(null, null).real < NEGLIGIBLE:
        return ShortWave(solver, None, solver.solve(generator.one))
    phi = (law @ null).conjugate()
    return ShortWave(solver, null, solver.solve(generator.one - phi * null))


def along_short_waves(
    generator: SmoothGenerator, laws: Sequence[Array], k: WaveVector
) -> Array:
    """Ŝ = 2 Re E u without what u has of e^{−ik·ξ}, see `ShortWave`.

    Parameters
    ----------
    generator : SmoothGenerator
    laws : sequence of ndarray
        Stationary laws of larger truncations; of each Ŝ is returned.
    k : (float, float)
    """
    _, null, solution = short_wave(generator, laws[0], k)
    if null is None:
        return np.array([2 * (law @ solution).real for law in laws])
    found = []
    for law in laws:
        row = multiplied(generator, law, (-k[0], -k[1]))
        kept = law @ null
        found.append(2 * (law @ solution - (row @ solution) * kept).real)
    return np.array(found)


class ByDegree:
    """A u = f by GMRES, preconditioned by the blocks of equal polynomials of ξ.

    Over waves much shorter than σ the place changes little until they are averaged
    out: what couples degrees is weak. A block is an equation in α and κ, the same for
    all polynomials of a degree.

    Parameters
    ----------
    operator
        Sparse A.
    basis : SmoothBasis
    """

    def __init__(self, operator: Any, basis: SmoothBasis) -> None:
        self.operator = operator
        self.blocks = []
        for part, n_planes in basis.degrees():
            first = slice(part.start, part.start + (part.stop - part.start) // n_planes)
            factors = splu(operator[first, first].tocsc())
            self.blocks.append((part, n_planes, factors))

    def solve(
        self, right: Any, trans: Literal["N", "T"] = "N", residual: float = RESIDUAL
    ) -> Complex:
        """u, or with `trans` "T" the solution of the transposed equation.

        Raises
        ------
        ToleranceError
            If the iteration does not converge: the wave is not short enough.
        """
        operator = self.operator if trans == "N" else self.operator.T
        product = LinearOperator(
            operator.shape,
            lambda f: operator @ self._preconditioned(f, trans),
            dtype=complex,
        )
        inner, _ = gmres(
            product, right, rtol=residual, atol=0.0, restart=VECTORS, maxiter=RESTARTS
        )
        solution = self._preconditioned(inner, trans)
        defect = np.linalg.norm(operator @ solution - right) / np.linalg.norm(right)
        if not defect <= FAILED * residual:
            raise ToleranceError(
                float(defect),
                FAILED * residual,
                "of the equation for a short wave, whatever is asked of its spectrum: "
                "raise the noise, for the fibre keeps its direction over too long a "
                "way",
            )
        return np.asarray(solution)

    def _preconditioned(self, f: Complex, trans: Literal["N", "T"]) -> Complex:
        found = np.empty_like(f)
        for part, n_planes, factors in self.blocks:
            columns = np.ascontiguousarray(f[part].reshape(n_planes, -1).T)
            found[part] = factors.solve(columns, trans=trans).T.ravel()
        return found
