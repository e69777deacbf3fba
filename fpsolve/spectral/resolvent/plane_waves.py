"""Plane waves e^{ik·ξ} in Hermite polynomials, and products with them."""

from __future__ import annotations

import math
from functools import singledispatch
from typing import Any

import numpy as np
from numpy.polynomial.hermite_e import hermegauss
from numpy.typing import NDArray

from fpsolve._support.arrays import Array, Complex
from fpsolve.spectral.bases.hermite_functions import hermite_polynomials
from fpsolve.spectral.resolvent.generator import Generator

__all__ = [
    "against_wave",
    "characteristic",
    "characteristic_changes",
    "multiplied",
    "plane_wave",
    "wave_derivative",
    "wave_vector",
]

# Nodes of Gauss beyond the degree, per squared and per plain wave number.
EXTRA, PER_SQUARE, PER_WAVE = 16, 0.5, 4.0

WaveVector = tuple[float, float]


def wave_vector(generator: Generator, k: WaveVector) -> WaveVector:
    """(k1 σ1, k2 σ2): the wave numbers of x = (ξ − c)/σ."""
    sigma1, sigma2 = generator.scales
    return k[0] * sigma1, k[1] * sigma2


def coefficients(q: float, degree: int) -> Complex:
    """Those of e^{iqx}: iᵐ qᵐ e^{−q²/2}/√m!, m = 0 … degree."""
    factors = 1j * q / np.sqrt(np.arange(1.0, degree + 1))
    powers = np.concatenate([[1.0 + 0.0j], np.cumprod(factors)])
    return np.asarray(powers * math.exp(-0.5 * q * q))


@singledispatch
def plane_wave(generator: Generator, k: WaveVector) -> Complex:
    """Coefficients of e^{ik·(ξ − c)} in the basis."""
    basis = generator.basis
    m, n, _ = basis.states
    along, across = (coefficients(q, basis.degree) for q in wave_vector(generator, k))
    wave = np.zeros(basis.size, complex)
    plain = basis.without_angle
    wave[plain] = along[m[plain]] * across[n[plain]]
    return wave


def wave_derivative(generator: Generator, k2: float) -> Complex:
    """∂/∂k2 of the coefficients of e^{ik2 ξ2}, k2 ≠ 0: (n/q − q) σ2 times them."""
    _, q = wave_vector(generator, (0.0, k2))
    _, n, _ = generator.basis.states
    wave = plane_wave(generator, (0.0, k2))
    return np.asarray(wave * (n / q - q) * generator.scales[1])


def characteristic(generator: Generator, k: WaveVector) -> complex:
    """E e^{ik·(ξ − c)} in the stationary law."""
    return complex(generator.stationary @ plane_wave(generator, k))


def characteristic_changes(generator: Generator, k2: float) -> Array:
    """φ(0, k2) and its derivatives, in the parameters and last in k2."""
    wave = plane_wave(generator, (0.0, k2))
    phi = generator.stationary @ wave
    by_k = generator.stationary @ wave_derivative(generator, k2)
    return np.array([phi, *(generator.stationary_derivatives @ wave), by_k]).real


@singledispatch
def multiplied(generator: Generator, k: WaveVector) -> Complex:
    """E e^{−ik·(ξ − c)} f in the stationary law, for every state f of the basis."""
    return against_wave(generator, k, generator.stationary)


def against_wave(generator: Generator, k: WaveVector, of: NDArray[Any]) -> Complex:
    """Coefficients of e^{−ik·(ξ − c)} times a function: a symmetric matrix times `of`.

    So it is also a functional after the multiplication, state by state.
    """
    basis = generator.basis
    m, n, harmonic = basis.states
    n_planes, n_harmonics = basis.degree + 1, 2 * basis.harmonics + 1
    table = np.zeros((n_planes, n_planes, n_harmonics), of.dtype)
    table[m, n, harmonic] = of
    along, across = (between(-q, basis.degree) for q in wave_vector(generator, k))
    half = along @ table.reshape(n_planes, -1)
    half = half.reshape(n_planes, n_planes, n_harmonics)
    whole = across @ half
    found: NDArray[np.complex128] = whole[m, n, harmonic]
    return found


def between(q: float, degree: int) -> Complex:
    """∫ he_m e^{iqx} he_n φ dx, m, n = 0 … degree, by Gauss's rule."""
    n_nodes = round(degree + EXTRA + PER_SQUARE * q * q + PER_WAVE * abs(q))
    x, weights = hermegauss(n_nodes)
    functions: Array = hermite_polynomials(degree, x)
    phases = np.exp(1j * q * x) * (weights / weights.sum())
    return np.asarray((functions * phases) @ functions.T)
