"""A density over κ as a trigonometric polynomial: its real modes, and back."""

from __future__ import annotations

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.grids.smooth import SmoothPhaseSpaceGrid

__all__ = ["CurvatureModes"]


class CurvatureModes:
    """u[i, j, c, k] = Σ_l E[c, l] p[i, j, k, l]: real Fourier modes in κ.

    Mode 0 is the sum over κ, the modes 2j - 1 and 2j are those of cos and sin of
    j π κ/Λ, and for an even number of cells the last is the sum with alternating signs.

    Parameters
    ----------
    grid : SmoothPhaseSpaceGrid

    Attributes
    ----------
    forward, backward : ndarray, shape (n_kappa, n_kappa)
        E and its inverse.
    stretching : ndarray, shape (n_kappa, n_kappa)
        From modes to ∂_κ(κ p) in the cells.
    """

    def __init__(self, grid: SmoothPhaseSpaceGrid) -> None:
        self.grid = grid
        n = grid.shape[3]
        angles = np.pi * grid.kappa / grid.kappa_half_width
        self.forward = np.ones((n, n))
        for number in range(1, (n + 1) // 2):
            self.forward[2 * number - 1] = np.cos(number * angles)
            self.forward[2 * number] = np.sin(number * angles)
        if n % 2 == 0:
            self.forward[n - 1, 1::2] = -1.0
        norms = (self.forward**2).sum(axis=1, keepdims=True)
        self.backward = np.ascontiguousarray((self.forward / norms).T)
        slopes = np.zeros((n, n))
        for number in range(1, (n + 1) // 2):
            at = 2 * number - 1
            wave = number * np.pi / grid.kappa_half_width
            slopes[:, at] = -wave * self.backward[:, at + 1]
            slopes[:, at + 1] = wave * self.backward[:, at]
        weighted = self.forward @ (grid.kappa[:, None] * self.backward)
        self.stretching = slopes @ weighted

    @property
    def shape(self) -> tuple[int, int, int, int]:
        """Shape (n1, n2, n_kappa, n_alpha) of the modes of a density."""
        n_xi1, n_xi2, n_alpha, n_kappa = self.grid.shape
        return n_xi1, n_xi2, n_kappa, n_alpha

    def of(self, p: Array) -> Array:
        """The modes of a density."""
        return np.ascontiguousarray(np.matmul(self.forward, p.swapaxes(2, 3)))

    def apply(self, matrix: Array, modes: Array, out: Array) -> None:
        """Write what a matrix makes of the modes, shape grid.shape, into `out`."""
        np.matmul(modes.swapaxes(2, 3), matrix.T, out=out)
