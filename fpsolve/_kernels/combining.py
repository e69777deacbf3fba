"""Weighted sums of several densities, in one pass over each."""

from numba import prange

from fpsolve._kernels.compiling import njit

CHUNK = 4096


@njit(cache=True, parallel=True, error_model="numpy")
def add_weighted(p, weights, sums, begin):
    """sums[m] += weights[m] p; p (n,), weights (m,), sums (m, n); = where `begin`."""
    n = p.size
    for chunk in prange((n + CHUNK - 1) // CHUNK):
        first = chunk * CHUNK
        last = min(first + CHUNK, n)
        for m in range(weights.size):
            weight = weights[m]
            if begin:
                for k in range(first, last):
                    sums[m, k] = weight * p[k]
            else:
                for k in range(first, last):
                    sums[m, k] += weight * p[k]
