"""Hermite polynomials and functions by their recurrence."""

from __future__ import annotations

import math

import numpy as np

from fpsolve._support.arrays import Array

__all__ = ["hermite_functions", "hermite_polynomials", "root_of_normal"]


def hermite_polynomials(degree: int, x: Array, first: Array | float = 1.0) -> Array:
    """he_m(x) times `first`, m = 0 ... degree, shape (degree + 1, x.size).

    The polynomials are orthonormal for the weight φ(x) = exp(-x²/2)/√(2π).
    """
    result = np.empty((degree + 1, x.size))
    result[0] = first
    if degree:
        result[1] = x * result[0]
    for m in range(1, degree):
        result[m + 1] = x * result[m] - math.sqrt(m) * result[m - 1]
        result[m + 1] /= math.sqrt(m + 1)
    return result


def hermite_functions(degree: int, x: Array) -> Array:
    """√φ(x) he_m(x), orthonormal in L²(dx); shape (degree + 1, x.size).

    Bounded, so that the recurrence neither overflows nor cancels.
    """
    return hermite_polynomials(degree, x, root_of_normal(x))


def root_of_normal(x: Array) -> Array:
    """√φ(x), φ the standard normal density."""
    return np.asarray(np.exp(-0.25 * x**2) / (2 * math.pi) ** 0.25)
