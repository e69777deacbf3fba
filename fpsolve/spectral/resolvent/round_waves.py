"""Plane waves e^{ik·ξ} in radial functions, and products with them."""

from __future__ import annotations

import math

import numpy as np
from scipy import fft
from scipy.linalg import eigh_tridiagonal
from scipy.special import jv

from fpsolve._support.arrays import Array, Complex
from fpsolve.spectral.resolvent.plane_waves import WaveVector, multiplied, plane_wave
from fpsolve.spectral.resolvent.round_generator import RoundGenerator

__all__ = ["of_round", "times_round"]

# Radians of e^{ik·ξ} over the rule, in units of its nodes, beyond which nothing of it
# is left in smooth functions: e^{−(kσ)²/2}, of B = r⁴ some e^{−50}.
OSCILLATING = 1.0
# Points on a circle beyond twice the degree, of a wave that turns k r radians.
PER_RADIAN, MORE = 1.5, 24


@plane_wave.register
def of_round(generator: RoundGenerator, k: WaveVector) -> Complex:
    """Of e^{ik·ξ} = Σ i^l J_l(|k| r) e^{il(φ − β)} the coefficients in the basis."""
    basis, rule = generator.basis, generator.radial.rule
    size, beta = math.hypot(*k), math.atan2(k[1], k[0])
    waves = np.zeros(basis.size, complex)
    if size * rule.r[-1] <= OSCILLATING * rule.r.size:
        m, n = basis.planes
        planes = np.zeros(m.size, complex)
        weight = np.exp(0.5 * rule.log_weight)
        for order in range(basis.degree + 1):
            functions = generator.radial.weighted(order, basis.degree)[0]
            part = functions @ (weight * jv(order, size * rule.r)) * 1j**order
            for angular in {order, -order}:
                found = m - n == angular
                planes[found] = part * np.exp(-1j * angular * beta)
        plain = basis.states[2] == 0
        waves[plain] = planes[: np.count_nonzero(plain)]
    return np.asarray(basis.real.conj().T @ waves)


@multiplied.register
def times_round(generator: RoundGenerator, k: WaveVector) -> Complex:
    """E e^{−ik·ξ} f in the stationary law, for every state f of the basis.

    At rest that law is the weight of the basis. Else on rings: Gauss's rule of r²
    times points at equal angles.
    """
    if generator.speed == 0:
        return plane_wave(generator, k).conj()
    basis = generator.basis
    r, functions = rings(generator)
    n_points = fft.next_fast_len(
        int(2 * basis.degree + MORE + PER_RADIAN * math.hypot(*k) * r[-1])
    )
    turn = 2 * math.pi / n_points * np.arange(n_points)
    place = np.multiply.outer(r, k[0] * np.cos(turn) + k[1] * np.sin(turn))
    density = generator.basis.real @ generator.stationary
    m, n, harmonic = basis.states
    table = np.zeros((basis.planes[0].size, 2 * basis.harmonics + 1), complex)
    plane = (m + n) * (m + n + 1) // 2 + n
    table[plane, harmonic] = density
    orders = np.arange(-basis.degree, basis.degree + 1)
    angular = np.subtract(*basis.planes)
    rows = [np.flatnonzero(angular == order) for order in orders]
    on_rings = np.zeros((r.size, n_points, table.shape[1]), complex)
    for order, found in zip(orders, rows, strict=True):
        on_rings[:, order] = functions[abs(order)].T @ table[found]
    values = fft.ifft(on_rings, axis=1) * np.exp(-1j * place)[:, :, None]
    back = fft.fft(values, axis=1)
    for order, found in zip(orders, rows, strict=True):
        table[found] = functions[abs(order)] @ back[:, order]
    return np.asarray(basis.real.conj().T @ table[plane, harmonic])


def rings(generator: RoundGenerator) -> tuple[Array, list[Array]]:
    """Radii of Gauss's rule of e^{−B} r dr in r², and √weight g_j^l there, by l."""
    radial, degree = generator.radial, generator.basis.degree
    family = radial.family(0)
    n = family.diagonal.size - 1
    x, vectors = eigh_tridiagonal(family.diagonal[:n], family.lower[1:n])
    r = family.unit * np.sqrt(x)
    # The first function is constant, 1: its share of a vector is √weight.
    weight = np.abs(vectors[0])
    functions = [
        weight * radial.evaluate(r, order, degree)[0] for order in range(degree + 1)
    ]
    return r, functions
