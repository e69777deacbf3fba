"""e^{sG} of a sparse matrix applied to a vector, by Chebyshev series on an ellipse."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import eigsh

from fpsolve._support.arrays import Array
from fpsolve.spectral.evolution.exponential import FLATTEST, REACH, STRIDE, bessel
from fpsolve.spectral.work import Work

__all__ = ["SparseExponential", "largest_eigenvalue"]

# How well the box around the numerical range is known, and how much it is widened.
LANCZOS, WIDER = 1e-2, 1.05
# Up to so many rows all eigenvalues are computed.
FEW = 40
# What has grown by so much is lost: the truncated equation is not stable.
GROWTH = 1e6


@dataclass(frozen=True, eq=False)
class SparseExponential:
    """x ↦ e^{ds G} x, as `ForwardOperator.advance` for a matrix that is stored.

    Attributes
    ----------
    matrix : csr_array
        G, real.
    """

    matrix: sparse.csr_array

    @cached_property
    def box(self) -> tuple[float, float, float]:
        """Centre and half width along ℜ, half width along ℑ, of the numerical range."""
        transposed = self.matrix.T.tocsr()
        symmetric = 0.5 * (self.matrix + transposed)
        skew = 0.5 * (self.matrix - transposed)
        highest = largest_eigenvalue(symmetric)
        lowest = -largest_eigenvalue(-symmetric)
        speed = math.sqrt(max(largest_eigenvalue(skew.T @ skew), 0.0))
        real = WIDER * 0.5 * (highest - lowest)
        return 0.5 * (highest + lowest), real, max(WIDER * speed, 1e-3)

    def __call__(self, x: Array, ds: float, tolerance: float, work: Work) -> Array:
        """e^{ds G} x to `tolerance`; ArithmeticError where it grows without bound."""
        _, real, imaginary = self.box
        n_steps = max(1, math.ceil(ds * (real + imaginary) / REACH))
        most = GROWTH * float(np.linalg.norm(x))
        for _ in range(n_steps):
            x = self._series(x, ds / n_steps, tolerance / n_steps, work)
            if not np.linalg.norm(x) <= most:
                raise ArithmeticError("the truncated equation is not stable.")
        return x

    def _series(self, x: Array, ds: float, tolerance: float, work: Work) -> Array:
        """Σ a_n U_n, see `ForwardOperator`."""
        centre, real, imaginary = self.box
        square = real**2 - imaginary**2
        focus = math.sqrt(max(abs(square), (FLATTEST * max(real, imaginary)) ** 2))
        sign = 1.0 if square > 0 else -1.0
        coefficients = bessel(centre * ds, focus * ds, sign)
        older, newer = x, (self.matrix @ x - centre * x) / focus
        total = coefficients[0] * older + coefficients[1] * newer
        for n in range(2, coefficients.size):
            work.spend(0.5 * self.matrix.nnz)
            newest = self.matrix @ newer
            newest -= centre * newer
            newest *= 2.0 / focus
            newest -= sign * older
            total += coefficients[n] * newest
            older, newer = newer, newest
            if n % STRIDE == 0 and n >= imaginary * ds:
                ahead = np.abs(coefficients[n + 1 : n + 1 + STRIDE]).max(initial=0.0)
                size = float(np.linalg.norm(older) + np.linalg.norm(newer))
                if ahead * size < tolerance:
                    return np.asarray(total)
        raise ArithmeticError("the Chebyshev series did not converge.")


def largest_eigenvalue(symmetric: sparse.csr_array) -> float:
    """Of a symmetric matrix; the same for every run, since the start is."""
    if symmetric.shape[0] <= FEW:
        return float(np.linalg.eigvalsh(symmetric.toarray())[-1])
    start = 1.0 / (1.0 + np.arange(symmetric.shape[0]) % 7)
    found = eigsh(
        symmetric, 1, which="LA", tol=LANCZOS, v0=start, return_eigenvectors=False
    )
    return float(found[0])
