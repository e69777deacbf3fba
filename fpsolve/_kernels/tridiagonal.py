"""Constant periodic tridiagonal systems along the angle, one per row.

The matrix circ(b, a, b) is split by Sherman and Morrison into a tridiagonal matrix
and a rank-one part; the elimination factors are the same for every row. Each value of
an elimination waits for the one before it, so four rows are eliminated together.
"""

import numpy as np
from numba import prange
from numba.extending import register_jitable

from fpsolve._kernels.compiling import njit
from fpsolve._kernels.lanes import LANES, fused, put, spread, take, transposed

# Quads of rows that share a work array.
TOGETHER = 16


@register_jitable(fastmath=False, error_model="numpy", forceinline=True)
def load_four(flat, starts, source):
    """Four rows of `flat` as the columns of source (n, 4)."""
    a, b, c, d = starts
    n = source.shape[0]
    for block in range((n + LANES - 1) // LANES):
        k = min(block * LANES, n - LANES)
        columns = transposed(
            take(flat, (a + k,)), take(flat, (b + k,)),
            take(flat, (c + k,)), take(flat, (d + k,)),
        )  # fmt: skip
        for place in range(LANES):
            put(source, (k + place, 0), columns[place])


@register_jitable(fastmath=False, error_model="numpy", forceinline=True)
def store_four(source, starts, flat):
    """The inverse of `load_four`."""
    n = source.shape[0]
    for block in range((n + LANES - 1) // LANES):
        k = min(block * LANES, n - LANES)
        rows = transposed(
            take(source, (k, 0)), take(source, (k + 1, 0)),
            take(source, (k + 2, 0)), take(source, (k + 3, 0)),
        )  # fmt: skip
        for one in range(LANES):
            put(flat, (starts[one] + k,), rows[one])


@njit(cache=True, error_model="numpy")
def solve_four(source, numbers, pivots, response, rows):
    """rows = circ(off, a, off)⁻¹ circ(side, centre, side) source, all (n, 4)."""
    n = pivots.size
    centre, side, off = spread(numbers[0]), spread(numbers[1]), spread(numbers[2])
    row = spread(0.0)
    for k in range(n):
        before, after = k - 1 if k > 0 else n - 1, k + 1 if k + 1 < n else 0
        beside = take(source, (before, 0)) + take(source, (after, 0))
        right = fused(side, beside, centre * take(source, (k, 0)))
        row = fused(-off, row, right) * spread(pivots[k])
        put(rows, (k, 0), row)
    for k in range(n - 2, -1, -1):
        row = fused(-off * spread(pivots[k]), row, take(rows, (k, 0)))
        put(rows, (k, 0), row)
    share = spread(numbers[2] / numbers[3])
    correction = fused(share, take(rows, (n - 1, 0)), row) * spread(numbers[4])
    for k in range(n):
        put(rows, (k, 0), fused(-correction, spread(response[k]), take(rows, (k, 0))))


@njit(cache=True, parallel=True, error_model="numpy")
def solve_rows(p, numbers, pivots, response, out):
    """out = circ(off, a, off)⁻¹ circ(side, centre, side) p along the last axis.

    p, out (n1, n2, n_alpha), `out` may be p; numbers (centre, side, off, gamma,
    scale), gamma the corner shift, scale = 1/(1 + vᵀ response); pivots (n_alpha,)
    inverse pivots of the corrected tridiagonal matrix; response (n_alpha,) its
    solution for the corner vector.
    """
    n = p.shape[2]
    n_rows = p.shape[0] * p.shape[1]
    given, solved = p.reshape(-1), out.reshape(-1)
    for block in prange((n_rows + LANES * TOGETHER - 1) // (LANES * TOGETHER)):
        source, rows = np.empty((n, LANES)), np.empty((n, LANES))
        for quad in range(block * TOGETHER, (block + 1) * TOGETHER):
            if quad * LANES < n_rows:
                # The last quad may hold the last row more than once.
                last, row = n_rows - 1, quad * LANES
                starts = (
                    row * n, min(row + 1, last) * n,
                    min(row + 2, last) * n, min(row + 3, last) * n,
                )  # fmt: skip
                load_four(given, starts, source)
                solve_four(source, numbers, pivots, response, rows)
                store_four(rows, starts, solved)
