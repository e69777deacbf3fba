"""Fourier coefficients of what fibres of one phase lay down on average."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array
from fpsolve.density.periodic.result import PeriodicState

__all__ = ["Complex", "Harmonics", "harmonics_of"]

Complex = NDArray[np.complex128]

# Quadrature in s: points for every oscillation of e^{−ik·γ}, and at least.
OVERSAMPLED, FEWEST_POINTS = 4, 64
# Harmonics of the phase above this share of those that are known tell how much is
# missing: for a density that is analytic in s they fall geometrically.
TAIL = 3 / 4
# Parts of the error of a density that are known in L1 only.
IN_SIZE_ONLY = ("box", "curvature")


@dataclass(frozen=True)
class Harmonics:
    """c = (1/P) ∫ e^{−ik·γ(s)} E e^{−ik·ξ(s)} ds over the period, for every k.

    Attributes
    ----------
    k1, k2 : ndarray, shape (n1,), (n2,)
        Wave numbers along and across the belt.
    values : ndarray of complex, shape (n1, n2)
    errors : ndarray, shape (n1, n2)
        What every value may be off, see `errors_of`.
    """

    k1: Array
    k2: Array
    values: Complex
    errors: Array


def harmonics_of(
    state: PeriodicState, curve: Any, period1: float, period2: float
) -> Harmonics:
    """The coefficients of a pattern with these periods that the cells resolve.

    Parameters
    ----------
    state : PeriodicState
    curve : Curve
        Of its model.
    period1, period2 : float
        Along and across the belt.
    """
    grid: Any = state.grid
    k1 = _wave_numbers(period1, grid.spacing[0])
    k2 = _wave_numbers(period2, grid.spacing[1])
    known = _transformed(grid, state.marginal("xi"), k1, k2)
    modes = np.fft.fft(known, axis=0) / state.s.size
    values = _averaged(modes, state.period, curve, k1, k2)
    return Harmonics(k1, k2, values, errors_of(state, modes, k1, k2))


def errors_of(state: PeriodicState, modes: Complex, k1: Array, k2: Array) -> Array:
    """(1/P) ∫ |∫ e^{−ik·ξ} δp| ds, δp the estimated errors of p; shape (n1, n2).

    Not summed over s with the phase of the wave, so that errors of different phases do
    not make up for each other. What is known of p in L1 only counts as it is, and what
    lies between the phases.
    """
    errors: Array = np.zeros((k1.size, k2.size))
    for field in state.plane_errors:
        errors += np.abs(_transformed(state.grid, field, k1, k2)).mean(axis=0)
    of_sizes = sum(state.errors.get(part, 0.0) for part in IN_SIZE_ONLY)
    errors += of_sizes
    errors += _between_phases(modes)
    return np.asarray(errors, dtype=np.float64)


def _wave_numbers(period: float, cell: float) -> Array:
    """2πn/period for all n up to where a cell is half a wave."""
    largest = int(period / (2 * cell))
    numbers: Array = np.arange(-largest, largest + 1, dtype=np.float64)
    numbers *= 2 * math.pi / period
    return numbers


def _transformed(grid: Any, planes: Array, k1: Array, k2: Array) -> Complex:
    """∫ e^{−ik·ξ} u dξ at every phase, by the midpoint rule; shape (n, n1, n2)."""
    planes = planes * (grid.spacing[0] * grid.spacing[1])
    first = np.exp(-1j * k1[:, None] * grid.xi1)
    second = np.exp(-1j * k2[:, None] * grid.xi2)
    found: Complex = np.einsum("ai,sij,bj->sab", first, planes, second, optimize=True)
    return found


def _averaged(
    modes: Complex, period: float, curve: Any, k1: Array, k2: Array
) -> Complex:
    """(1/P) ∫ e^{−ik·γ} φ(s) ds, φ interpolated by its harmonics in s."""
    n = modes.shape[0]
    wide = 2 * n + FEWEST_POINTS
    reach = max(
        float(np.abs(k1).max()) * _reach(curve, period, 0),
        float(np.abs(k2).max()) * _reach(curve, period, 1),
    )
    points = wide + OVERSAMPLED * math.ceil(reach)
    s = np.arange(points) * (period / points)
    gamma1, gamma2 = curve.position(s)
    number = np.fft.fftfreq(n, 1 / n)
    values = np.zeros(modes.shape[1:], dtype=np.complex128)
    for at, along, across in zip(s, gamma1, gamma2, strict=True):
        turned = np.exp(2j * math.pi / period * at * number)
        if n % 2 == 0:
            # The highest harmonic belongs to both signs.
            turned[n // 2] = turned[n // 2].real
        phi = np.tensordot(turned, modes, 1)
        values += np.exp(-1j * (k1[:, None] * along + k2 * across)) * phi
    values /= points
    return values


def _reach(curve: Any, period: float, direction: int) -> float:
    """How far the curve goes within a period."""
    position = curve.position(np.linspace(0.0, period, FEWEST_POINTS))[direction]
    return float(np.ptp(position))


def _between_phases(modes: Complex) -> Array:
    """For every k what the phases do not tell."""
    n = modes.shape[0]
    number = np.abs(np.fft.fftfreq(n, 1 / n))
    missed: Array = 2.0 * np.abs(modes[number >= TAIL * n / 2]).sum(axis=0)
    return missed
