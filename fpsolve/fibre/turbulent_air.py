"""Strength of turbulence along a fibre, of another k and ε at every node."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache

import numpy as np
from scipy.interpolate import CubicSpline

from fpsolve._kernels.flow import cubic_values
from fpsolve._support.arrays import Array
from fpsolve.fibre.turbulence import (
    FALLING,
    RISING,
    TurbulenceSpectrum,
    bessel_parts,
    energy_of,
)

__all__ = ["smallest_energy", "white_amplitudes"]

# √(ln k − ln k_min) up to which κ₁ and κ₂ are tabulated, and values in between.
REACH, PLACES = 7.0, 600
# ln q between which integrals over E are tabulated, and how closely: 1e-10 of their
# limits is left at the ends, splines are off by as much in between.
SLOW, FAST, STEP = -14.0, 12.0, 0.025
# Lengths in ln κ of the three parts of E: what lies beyond has lost e^−29 and more.
BELOW, BETWEEN, BEYOND = 12.0, 18.0, 5.0
# Of a quadrature over ln κ, for pieces of about this length.
PER_PIECE, PIECE = 16, 2.5


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

    With y = κ/κ_i and q_i = κ_i |w_n| t_T integrals of E/κ over the two ends of the
    spectrum and over the powers from κ_i on are functions of q_i alone,

        ∫ E/κ J dκ = C_K ε^(2/3) (κ₁^(−5/3) P(q₁) + κ₂^(−5/3) Q(q₂)) ,

    tabulated over ln q for J₀ and for J₀ − J₁; κ₁ and κ₂ are over k/(C_K^(3/2) √(νε)).
    Errors are below 1e-8 of the first amplitude, as a quadrature says.

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
    scaled = k / _energy_scale(dissipation, viscosity, constant)
    # Rounding of the smallest energy itself.
    above = np.sqrt(np.maximum(np.log(scaled / energy_of(1.0)), 0.0))
    unit = (dissipation ** (1 / 3) / (2 * viscosity * constant)) ** 0.75
    ends = unit * np.exp(_inertial_ranges()(above))
    level = constant * dissipation ** (2 / 3)
    if decay_time is None:
        first, last = (
            end ** (-8 / 3) * part for end, part in zip(ends, _frozen(), strict=True)
        )
        square = 2 * math.pi * level * (first + last) / speed
        return np.asarray(np.sqrt(np.stack([square, square, 0.0 * square])))
    passed = ends * (speed * decay_time)
    even, less = np.sum(
        [
            end ** (-5 / 3) * _from_table(table, q)
            for end, table, q in zip(ends, _decaying(), passed, strict=True)
        ],
        axis=0,
    )
    squares = np.stack([even, even - 0.5 * less, 0.5 * less])
    squares *= (2 * math.pi) ** 1.5 / 2 * level * decay_time
    return np.asarray(np.sqrt(np.maximum(squares, 0.0)))


class _Table:
    """Cubic splines through values (m, n) at equally spaced places."""

    def __init__(self, places: Array, values: Array) -> None:
        spline = CubicSpline(places, values.T)
        self.first, self.step = float(places[0]), float(places[1] - places[0])
        self.cubics = np.ascontiguousarray(spline.c)

    def __call__(self, x: Array) -> Array:
        """Values at x (n,), shape (m, n)."""
        out = np.empty((self.cubics.shape[2], x.size))
        cubic_values(self.first, self.step, self.cubics, x, out)
        return out


def _from_table(table: _Table, q: Array) -> Array:
    """∫ of J₀ and of J₀ − J₁, shape (2, n)."""
    place = np.log(np.clip(q, math.exp(SLOW), math.exp(FAST)))
    grown = 1 + q**2
    even, less = table(place)
    root = np.sqrt(grown)
    return np.stack([even / root, less / (root * grown)])


@cache
def _decaying() -> tuple[_Table, _Table]:
    """√(1 + q²) P of J₀ and (1 + q²)^(3/2) P of J₀ − J₁ over ln q, and those of Q."""
    places = np.linspace(SLOW, FAST, round((FAST - SLOW) / STEP) + 1)
    q = np.exp(places)
    scale = np.sqrt(1 + q**2) ** np.array([[1], [3]])
    below = _integrals(q, -BELOW, 0.0, _sum(RISING))
    between = _integrals(q, 0.0, BETWEEN, lambda y: y ** (-5 / 3))
    beyond = _integrals(q, 0.0, BEYOND, _sum(FALLING))
    return (
        _Table(places, scale * (below + between)),
        _Table(places, scale * (beyond - between)),
    )


def _integrals(
    q: Array, low: float, high: float, shape: Callable[[Array], Array]
) -> Array:
    """∫ shape(y) J(q² y²/4) dy/y over ln y of J₀ and of J₀ − J₁, shape (2, q.size)."""
    places, weights = np.polynomial.legendre.leggauss(PER_PIECE)
    ends = np.linspace(low, high, math.ceil((high - low) / PIECE) + 1)
    half = 0.5 * np.diff(ends)[:, None]
    y = np.exp(ends[:-1, None] + half * (places + 1)).ravel()
    weighted = (half * weights).ravel() * shape(y)
    even, less = bessel_parts((np.multiply.outer(q, y) / 2) ** 2)
    return np.stack([even @ weighted, less @ weighted])


@cache
def _frozen() -> tuple[float, float]:
    """P and Q of ∫ E/κ² dκ = C_K ε^(2/3) (κ₁^(−8/3) P + κ₂^(−8/3) Q)."""
    (rising, a), (falling, b) = RISING, FALLING
    # The powers are those of y; between both it is y^(−5/3).
    return float(a @ (1 / (rising - 1)) + 3 / 8), float(b @ (1 / (1 - falling)) - 3 / 8)


@cache
def _inertial_ranges() -> _Table:
    """ln κ₁, ln κ₂ over √(ln k − ln k_min) for C_K = ε = 2ν = 1."""
    above = np.linspace(0.0, REACH, PLACES)
    spectra = [
        TurbulenceSpectrum(k, 1.0, 0.5, 1.0)
        for k in energy_of(1.0) * np.exp(above**2) * (1 + 1e-15)
    ]
    return _Table(above, np.log([one.inertial_range for one in spectra]).T)


def _energy_scale(dissipation: Array, viscosity: float, constant: float) -> Array:
    """C_K^(3/2) √(2νε)."""
    return np.asarray(constant**1.5 * np.sqrt(2 * viscosity * dissipation))


def _sum(part: tuple[Array, Array]) -> Callable[[Array], Array]:
    """Y ↦ Σ_j a_j y^j."""
    powers, coefficients = part
    return lambda y: np.asarray(np.power.outer(y, powers) @ coefficients)
