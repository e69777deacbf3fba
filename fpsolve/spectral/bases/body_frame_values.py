"""Functions in the frame of a smooth fibre, on a grid of (ξ, α, κ)."""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np
from scipy.special import gammaln

from fpsolve._support.arrays import Array, Complex
from fpsolve.spectral.bases.hermite_functions import hermite_polynomials
from fpsolve.spectral.bases.sectors import Vector
from fpsolve.spectral.bases.weights import Weight

__all__ = ["Cells", "values_on"]

# Complex numbers in memory at a time.
CHUNK = 2**21


class Cells(Protocol):
    """Centres of the cells of a grid, whatever the units of its plane."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Numbers of cells."""

    @property
    def alpha(self) -> Array:
        """Angles."""

    @property
    def kappa(self) -> Array:
        """Curvatures."""

    def plane(self) -> tuple[Array, Array]:
        """Positions, shapes (n1, 1) and (1, n2)."""


def values_on(
    table: Vector,
    index: int,
    position: Weight,
    curvature: Weight,
    grid: Cells,
) -> Complex:
    """Σ table[n_a, n_b, j] of functions e^{ilφ + i(M-l)α} iʲ times the weights.

    Parameters
    ----------
    table : ndarray, shape (degree + 1, degree + 1, curvature + 1)
    index : int
        M.
    position, curvature : Weight
        Their exponents are those of the Gaussians exp(-‖ξ‖²/(2S²)) and exp(-κ²/(2g²)).
    grid : Cells
        As a SmoothPhaseSpaceGrid.

    Returns
    -------
    ndarray, shape ``grid.shape``
    """
    degree = table.shape[0] - 1
    angular = np.arange(-degree, degree + 1)
    radial = by_index(table)
    kappa = in_curvature(table.shape[2] - 1, curvature, grid.kappa)
    circle = np.exp(1j * np.multiply.outer(index - angular, grid.alpha))
    xi1, xi2 = (axis.ravel() for axis in np.broadcast_arrays(*grid.plane()))
    result = np.empty((xi1.size, *grid.shape[2:]), np.complex128)
    width = (2 * degree + 1) * max(grid.kappa.size, table.shape[2])
    step = max(1, CHUNK // width)
    for start in range(0, xi1.size, step):
        part = slice(start, start + step)
        waves = in_plane(radial, xi1[part], xi2[part], position) @ kappa
        # Sum over l: [point, l, κ] with [l, α].
        result[part] = np.einsum("plk,la->pak", waves, circle, optimize=True)
    return result.reshape(grid.shape)


def by_index(table: Vector) -> Vector:
    """Coefficients [l + degree, number, j]: number = min(n_a, n_b)."""
    side = table.shape[0]
    result = np.zeros((2 * side - 1, side, table.shape[2]), table.dtype)
    for angular in range(1 - side, side):
        number = np.arange(side - abs(angular))
        row = table[number + max(angular, 0), number + max(-angular, 0)]
        result[angular + side - 1, : len(number)] = row
    return result


def in_curvature(degree: int, weight: Weight, kappa: Array) -> Complex:
    """iʲ he_j(κ/g) exp(-exponent κ²/(2g²)), shape (degree + 1, n)."""
    x = kappa / math.sqrt(weight.variance)
    first = np.exp(-0.5 * weight.exponent * x**2)
    phases = 1j ** np.arange(degree + 1)
    functions = phases[:, None] * hermite_polynomials(degree, x, first)
    return np.asarray(functions, np.complex128)


def in_plane(radial: Vector, xi1: Array, xi2: Array, weight: Weight) -> Complex:
    """[point, l, j]: sums over the radial functions, times e^{ilφ} and the weight."""
    degree = radial.shape[1] - 1
    square = (xi1**2 + xi2**2) / (2 * weight.variance)
    angle = np.arctan2(xi2, xi1)
    result = np.empty((square.size, *radial.shape[::2]), np.complex128)
    for row, coefficients in enumerate(radial):
        angular = row - degree
        count = (degree - abs(angular)) // 2 + 1
        functions = laguerre_functions(abs(angular), count, square, weight.exponent)
        sums = functions.T @ coefficients[:count]
        result[:, row] = np.exp(1j * angular * angle)[:, None] * sums
    return result


def laguerre_functions(index: int, count: int, x: Array, exponent: float) -> Array:
    """(-1)^m √(m!/(m + l)!) x^{l/2} L_m^{(l)}(x) e^{-exponent x}, m < count.

    Three-term recurrence of multiplication by x, stable for growing m.
    """
    result = np.empty((count, x.size))
    with np.errstate(divide="ignore", invalid="ignore"):
        logarithm = 0.5 * index * np.log(x) if index else np.zeros_like(x)
    result[0] = np.exp(logarithm - exponent * x - 0.5 * gammaln(index + 1.0))
    if count > 1:
        result[1] = (x - 1 - index) * result[0] / math.sqrt(1.0 + index)
    for m in range(2, count):
        lower = math.sqrt((m - 1) * (m - 1 + index))
        step = (x - (2 * m - 1 + index)) * result[m - 1] - lower * result[m - 2]
        result[m] = step / math.sqrt(m * (m + index))
    return result
