"""Strength of turbulence along a fibre, of another k and ε at every node."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.special import i0e, i1e

from fpsolve._support.arrays import Array
from fpsolve.fibre.turbulence import FALLING, RISING, TurbulenceSpectrum, energy_of

__all__ = ["smallest_energy", "white_amplitudes"]

# Of a quadrature over ln κ in each of the three parts of E.
PER_PART = 20
# Lengths in ln κ of the first and the last: E/κ has lost 1e-9 of its integral.
BELOW, BEYOND = 5.5, 3.5
# √(ln k − ln k_min) up to which κ₁ and κ₂ are tabulated, and values in between.
REACH, PLACES = 7.0, 400


def smallest_energy(dissipation: Array, viscosity: float, constant: float) -> Array:
    """The k below which ε leaves no inertial range: 1.4394 C_K^(3/2) √(νε)."""
    return energy_of(1.0) * _energy_scale(dissipation, viscosity, constant)


def white_amplitudes(
    k: Array,
    dissipation: Array,
    speed: Array,
    *,
    viscosity: float,
    constant: float,
    decay_time: Array | None,
) -> Array:
    """`TurbulenceSpectrum.decaying_amplitudes` of another spectrum for every node.

    By a quadrature of fewer places, and κ₁ and κ₂ from a table over k/(C_K^(3/2)
    √(νε)), between which it is a cubic: errors are below 1e-4 of the first amplitude,
    of frozen turbulence 1e-6.

    Parameters
    ----------
    k, dissipation, speed : ndarray, shape (n,)
        k of at least `smallest_energy`; the speed may vanish.
    viscosity, constant : float
        ν and C_K.
    decay_time : ndarray, shape (n,), or None
        t_T; None for frozen turbulence, whose speed must be positive.

    Returns
    -------
    ndarray, shape (3, n)
        In m^(3/2)/s^(1/2): along the fibre, along w_n, along their normal.
    """
    kappa, energies = _quadrature(k, dissipation, viscosity, constant)
    if decay_time is None:
        square = 2 * math.pi * (energies / kappa**2).sum(axis=1) / speed
        return np.asarray(np.sqrt(np.stack([square, square, 0.0 * square])))
    a = ((speed * decay_time)[:, None] * kappa / 2) ** 2
    even, odd = i0e(a), i1e(a)
    shapes = np.stack([even, 0.5 * (even + odd), 0.5 * (even - odd)])
    squares = (shapes * (energies / kappa)).sum(axis=2)
    squares *= (2 * math.pi) ** 1.5 / 2 * decay_time
    return np.asarray(np.sqrt(np.maximum(squares, 0.0)))


def _quadrature(
    k: Array, dissipation: Array, viscosity: float, constant: float
) -> tuple[Array, Array]:
    """Wave numbers and E dκ at them, shape (n, 3 PER_PART)."""
    scaled = k / _energy_scale(dissipation, viscosity, constant)
    # Rounding of the smallest energy itself.
    above = np.sqrt(np.maximum(np.log(scaled / energy_of(1.0)), 0.0))
    unit = (dissipation ** (1 / 3) / (2 * viscosity * constant)) ** 0.75
    first, last = unit * np.exp(_inertial_ranges()(above)).T
    places, weights = np.polynomial.legendre.leggauss(PER_PART)
    inside, steps = 0.5 * (places + 1), 0.5 * weights
    first, last = first[:, None], last[:, None]
    decades = np.log(last / first)
    below, beyond = np.exp(BELOW * (inside - 1)), np.exp(BEYOND * inside)
    between = first * np.exp(decades * inside)
    rising = _sum(RISING, below) * below * BELOW * steps
    falling = _sum(FALLING, beyond) * beyond * BEYOND * steps
    # E of the inertial range at κ is κ^(−5/3), dκ is κ d ln κ.
    parts = (
        first ** (-2 / 3) * rising,
        between ** (-2 / 3) * decades * steps,
        last ** (-2 / 3) * falling,
    )
    kappa = np.concatenate([first * below, between, last * beyond], axis=1)
    level = constant * dissipation[:, None] ** (2 / 3)
    return kappa, level * np.concatenate(parts, axis=1)


@cache
def _inertial_ranges() -> CubicSpline:
    """ln κ₁, ln κ₂ over √(ln k − ln k_min) for C_K = ε = 2ν = 1."""
    above = np.linspace(0.0, REACH, PLACES)
    spectra = [
        TurbulenceSpectrum(k, 1.0, 0.5, 1.0)
        for k in energy_of(1.0) * np.exp(above**2) * (1 + 1e-15)
    ]
    return CubicSpline(above, np.log([one.inertial_range for one in spectra]))


def _energy_scale(dissipation: Array, viscosity: float, constant: float) -> Array:
    """C_K^(3/2) √(2νε)."""
    return np.asarray(constant**1.5 * np.sqrt(2 * viscosity * dissipation))


def _sum(part: tuple[Array, Array], x: Array) -> Array:
    """Σ_j a_j x^j."""
    powers, coefficients = part
    return np.asarray(np.power.outer(x, powers) @ coefficients)
