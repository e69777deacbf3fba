"""Finite elements of high degree, graded to g = 0, for the Sturm-Liouville problem."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial.legendre import leggauss, legvander
from numpy.typing import NDArray

from fpsolve._support.arrays import Array
from fpsolve.reduced.energy.averages import OrbitAverages

__all__ = ["Elements", "graded_faces"]


# Ratio of neighbouring elements: S has a logarithm at g = 0, and functions analytic
# away from it converge like 3^-2p in the eigenvalue on elements of this ratio.
_RATIO = 0.25
# The smallest element: its square, the size of the singular part of an eigenfunction
# (g² ln g), is below rounding.
_N_ELEMENTS = 15


def graded_faces(
    g_max: float, n_elements: int = _N_ELEMENTS, n_above: int = 0
) -> Array:
    """Elements that shrink towards g = 0, their last cut again towards g_max.

    The faces are 0, g_max 4^-k for k < n_elements, and n_above further ones.
    """
    low = _RATIO ** np.arange(n_elements - 1, 0, -1)
    high = 1.0 - (1.0 - _RATIO) * _RATIO ** np.arange(1, n_above + 1)
    return g_max * np.concatenate([[0.0], low, high, [1.0]])


@dataclass(frozen=True)
class Elements:
    """Continuous functions on [0, g_max] with u(0) = 0, polynomials on each element.

    A basis function has one Legendre polynomial on one element as its derivative: a
    ramp that stays at its height, or a bubble. ∫ J u'v' is then a sum over elements
    without cancellation, however small they are.

    Attributes
    ----------
    faces : ndarray, shape (n_elements + 1,)
    degree : int
        Of the functions; their derivatives have `degree` Legendre modes an element.
    """

    faces: Array
    degree: int

    @classmethod
    def of(cls, averages: OrbitAverages, degree: int) -> Elements:
        """Elements for the orbits of one well.

        Graded to g = 0; to g_max too where the period is steep there, in a well that is
        nearly flat.
        """
        n_above = 2 * averages.steepness
        return cls(graded_faces(averages.well.g_max, n_above=n_above), degree)

    @property
    def size(self) -> int:
        """Number of basis functions."""
        return (len(self.faces) - 1) * self.degree

    @property
    def modes(self) -> NDArray[np.intp]:
        """Degree of the derivative of each basis function, shape (size,)."""
        return np.tile(np.arange(self.degree), len(self.faces) - 1)

    def quadrature(self) -> tuple[Array, Array]:
        """Gauss points of all elements in ascending order, and their weights.

        In the first element they are Gauss points of √g, which suit the singularity of
        S at 0 and are still exact for the polynomials.
        """
        nodes, weights = leggauss(2 * self.degree + 2)
        nodes, weights = (nodes + 1.0) / 2, weights / 2
        width = np.diff(self.faces)[:, None]
        points, shares = self.faces[:-1, None] + width * nodes, width * weights
        points[0], shares[0] = width[0] * nodes**2, width[0] * 2.0 * nodes * weights
        return points.ravel(), shares.ravel()

    def values(self, g: Array) -> Array:
        """Basis functions at g, shape (size, len(g))."""
        half = 0.5 * np.diff(self.faces)[:, None, None]
        return np.asarray(
            (half * _ramps(self._places(g), self.degree)).reshape(self.size, -1)
        )

    def combined(self, coefficients: Array, g: Array) -> Array:
        """Σ coefficients · basis functions at g, shape (len(g),).

        In the element of each g alone: of the elements below, only the ramps of P_0
        have a height that stays.
        """
        half = 0.5 * np.diff(self.faces)
        element = np.clip(np.searchsorted(self.faces, g) - 1, 0, len(half) - 1)
        x = np.clip((g - self.faces[element]) / half[element] - 1.0, -1.0, 1.0)
        shares = half[:, None] * coefficients.reshape(-1, self.degree)
        below = np.concatenate([[0.0], 2.0 * np.cumsum(shares[:-1, 0])])
        ramps = _ramps(x[None, :], self.degree)[0]
        return np.asarray(
            below[element] + np.einsum("kn,nk->n", ramps, shares[element])
        )

    def slopes(self, g: Array) -> Array:
        """Derivatives of the basis functions at g, none on a face, (size, len(g))."""
        x = self._places(g)
        inside = (np.abs(x) < 1.0)[:, None, :]
        modes = np.moveaxis(legvander(x, self.degree - 1), -1, 1)
        return np.asarray((inside * modes).reshape(self.size, -1))

    def _places(self, g: Array) -> Array:
        """Coordinates of g in every element, clipped to [-1, 1]."""
        width = np.diff(self.faces)[:, None]
        return np.clip(2.0 * (g - self.faces[:-1, None]) / width - 1.0, -1.0, 1.0)


def _ramps(x: Array, degree: int) -> Array:
    """∫ P_k from -1 to x for k < degree, shape (n_elements, degree, n)."""
    modes = np.moveaxis(legvander(x, degree), -1, 1)
    k = np.arange(1, degree)[:, None]
    ramps = np.empty((x.shape[0], degree, x.shape[1]))
    ramps[:, 0] = x + 1.0
    ramps[:, 1:] = (modes[:, 2:] - modes[:, :-2]) / (2 * k + 1)
    return ramps
