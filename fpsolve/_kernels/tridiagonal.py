"""Constant periodic tridiagonal systems along the angle, one per row.

The matrix circ(b, a, b) is split by Sherman and Morrison into a tridiagonal matrix
and a rank-one part; the elimination factors are the same for every row.
"""

import numpy as np
from numba import prange

from fpsolve._kernels.compiling import njit


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def eliminate(pivots, off, row):
    """Solve the tridiagonal part in place; pivots (n,) inverse pivots, row (n,)."""
    n = row.size
    row[0] *= pivots[0]
    for k in range(1, n):
        row[k] = (row[k] - off * row[k - 1]) * pivots[k]
    for k in range(n - 2, -1, -1):
        row[k] -= off * pivots[k] * row[k + 1]


@njit(cache=True, parallel=True, fastmath={"contract"}, error_model="numpy")
def solve_rows(p, numbers, pivots, response, out):
    """out = circ(off, a, off)⁻¹ circ(side, centre, side) p along the last axis.

    p, out (n1, n2, n_alpha), `out` may be p; numbers (centre, side, off, gamma,
    scale), gamma the corner shift, scale = 1/(1 + vᵀ response); pivots (n_alpha,)
    inverse pivots of the corrected tridiagonal matrix; response (n_alpha,) its
    solution for the corner vector.
    """
    n1, n2, n = p.shape
    centre, side, off, gamma, scale = numbers
    for i in prange(n1):
        row = np.empty(n)
        for j in range(n2):
            source = p[i, j]
            row[0] = centre * source[0] + side * (source[n - 1] + source[1])
            for k in range(1, n - 1):
                row[k] = centre * source[k] + side * (source[k - 1] + source[k + 1])
            row[n - 1] = centre * source[n - 1] + side * (source[n - 2] + source[0])
            eliminate(pivots, off, row)
            correction = (row[0] + off / gamma * row[n - 1]) * scale
            for k in range(n):
                out[i, j, k] = row[k] - correction * response[k]
