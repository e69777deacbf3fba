"""Weights of translations by a fraction of a cell, and how taps are laid out."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array

# Weights that belong to the taps first, first + 1, …; shape (n_taps, n_alpha).
Taps = tuple[int, Array]

HIGHEST_ORDER = 16


def lagrange_weights(fraction: Array, order: int) -> Array:
    """Weights w_t of p(x − f) ≈ Σ_t w_t p(x − t), taps t = 1 − order/2, …, order/2.

    Exact for polynomials of degree below `order`; the weights sum to one. The foot
    lies between the two middle nodes, which keeps the shift stable in L².

    Parameters
    ----------
    fraction : ndarray, shape (n,)
        Shift in cells, 0 ≤ f < 1.
    order : int
        Even number of points.

    Returns
    -------
    ndarray, shape (order, n)
    """
    taps = np.arange(1 - order // 2, order // 2 + 1)
    weights = np.ones((order, fraction.size))
    for row, other in enumerate(taps):
        # The factor of every tap but this one itself.
        apart = np.where(taps == other, 1, taps - other)
        factors = (fraction - other) / apart[:, None]
        factors[row] = 1.0
        weights *= factors
    return unit_sum(weights / weights.sum(axis=0))


def unit_sum(weights: Array) -> Array:
    """Weights whose exact sum over the taps is as close to one as it can be.

    A sum that is off by 1e-16 in the same direction at every step would show in the
    mass after a thousand steps.
    """
    middle = weights.shape[0] // 2
    for column in weights.T:
        column[middle] += 1.0 - math.fsum(column)
    return weights


def flux_weights(fraction: Array, order: int) -> Array:
    """Weights c_t of the flux F_{i+½} = Σ_t c_t p_{i−t} that gives the same shift.

    p_i − (F_{i+½} − F_{i−½}) = Σ_t w_t p_{i−t}, so the shift telescopes and keeps
    the sum; taps t = 1 − order/2, …, order/2 − 1. Shape (order − 1, n).
    """
    weights = lagrange_weights(fraction, order)
    taps = np.arange(1 - order // 2, order // 2)
    return np.where(taps[:, None] < 0, 0.0, 1.0) - np.cumsum(weights, axis=0)[:-1]


def whole_and_fraction(shift: Array) -> tuple[NDArray[np.int64], Array]:
    """Shift in cells as m + f with an integer m and 0 ≤ f < 1."""
    whole = np.floor(shift)
    return whole.astype(np.int64), shift - whole


def spread(weights: Array, first: int, whole: NDArray[np.int64]) -> Taps:
    """Weights moved by `whole[k]` taps onto one range of taps common to all angles.

    Zero where an angle does not use a tap.
    """
    n_taps, n = weights.shape
    lowest, highest = int(whole.min()), int(whole.max())
    length = n_taps + highest - lowest
    dense = np.zeros((length, n))
    rows = np.arange(n_taps)[:, None] + (whole - lowest)
    dense[rows, np.arange(n)] = weights
    return first + lowest, dense


def shift_taps(shift: Array, order: int) -> Taps:
    """Taps of a translation by `shift[k]` cells."""
    whole, fraction = whole_and_fraction(shift)
    return spread(lagrange_weights(fraction, order), 1 - order // 2, whole)


def flux_taps(shift: Array, order: int) -> tuple[Taps, Taps]:
    """Taps of the fluxes and of the donor cells of a translation by `shift[k]`."""
    whole, fraction = whole_and_fraction(shift)
    fluxes = spread(flux_weights(fraction, order), 1 - order // 2, whole)
    donors = spread(np.ones((1, shift.size)), 0, whole)
    return fluxes, donors


def check_order(order: int, highest: int = HIGHEST_ORDER) -> int:
    """Return `order` if it is an even number of points within range."""
    if not (isinstance(order, int) and order % 2 == 0 and 2 <= order <= highest):
        raise ValueError(
            f"`interpolation_order` must be an even integer from 2 to {highest}, "
            f"got {order!r}; 8 suits smooth densities."
        )
    return order
