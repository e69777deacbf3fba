"""Interpolation of functions that are even in a wave number, denser near zero."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array

__all__ = ["EvenNodes"]

# Coefficients that are left out for an estimate of the error.
LEFT_OUT = 2


@dataclass(frozen=True)
class EvenNodes:
    """Even polynomials in x = arsinh(k/w)/arsinh(end/w) through nodes on 0 <= k <= end.

    An even analytic function of k is one of x, and Σ c_i T_{2i}(x) converges to it
    geometrically. The nodes x_j = cos(πj/(2n − 2)) are some of those of 2n − 1.

    Attributes
    ----------
    end : float
    scale : float
        w, the width of what happens near zero.
    n : int
        Number of nodes.
    """

    end: float
    scale: float
    n: int

    @property
    def points(self) -> Array:
        """k of the nodes, from `end` down to zero."""
        x = np.cos(0.5 * np.pi * np.arange(self.n) / (self.n - 1))
        x[-1] = 0.0
        k = self.scale * np.sinh(x * math.asinh(self.end / self.scale))
        k[0] = self.end
        return np.asarray(k)

    def finer(self) -> EvenNodes:
        """With the same nodes and one between any two."""
        return EvenNodes(self.end, self.scale, 2 * self.n - 1)

    def at(self, k: ArrayLike, fewer: bool = False) -> Array:
        """Matrix from values at the nodes to those at k; `fewer` without the last T."""
        x = np.arcsinh(np.asarray(k, float) / self.scale)
        angle = np.arccos(np.clip(x / math.asinh(self.end / self.scale), 0.0, 1.0))
        kept = self.n - LEFT_OUT if fewer else self.n
        waves = np.cos(2.0 * np.multiply.outer(angle, np.arange(kept)))
        return np.asarray(waves @ self._coefficients[:kept])

    @property
    def _coefficients(self) -> Array:
        """From values at the nodes to c_i, a discrete cosine transform."""
        last = self.n - 1
        halved = np.ones(self.n)
        halved[[0, last]] = 0.5
        table = np.cos(np.pi * np.outer(np.arange(self.n), np.arange(self.n)) / last)
        return np.asarray(2.0 / last * halved[:, None] * table * halved)
