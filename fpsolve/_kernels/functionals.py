"""Row functionals of a density: one pass over p leaves sums for every ξ.

Sums over ξ are left to numpy, so that they do not depend on threads.
"""

import numpy as np
from numba import njit, prange

# Staggered first difference of order eight: the weights of q[k+1+j] − q[k−j].
NEAR, NEXT, THIRD, FAR = 1225.0 / 1024.0, -245.0 / 3072.0, 49.0 / 5120.0, -5.0 / 7168.0

N_FUNCTIONALS = 6


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def squared_differences(padded, n_alpha):
    """Σ_k (δq)²_{k+½} with the staggered eighth-order difference δ, unit spacing.

    padded (n_alpha + 7,): q periodic with three cells before and four behind.
    """
    total = 0.0
    for k in range(n_alpha):
        slope = (
            NEAR * (padded[k + 4] - padded[k + 3])
            + NEXT * (padded[k + 5] - padded[k + 2])
            + THIRD * (padded[k + 6] - padded[k + 1])
            + FAR * (padded[k + 7] - padded[k])
        )
        total += slope * slope
    return total


@njit(cache=True, parallel=True, fastmath={"contract"}, error_model="numpy")
def row_functionals(p, cosine, sine, out):
    """out[i, j] = Σ_k of p, p cos α, p sin α, (δ√p)², min_k p, and Σ_k max(−p, 0).

    p (n1, n2, n_alpha); cosine, sine (n_alpha,); out (n1, n2, 6). Negative values
    count as zero under the root.
    """
    n1, n2, n_alpha = p.shape
    for i in prange(n1):
        padded = np.empty(n_alpha + 8)
        for j in range(n2):
            total = 0.0
            total_cosine = 0.0
            total_sine = 0.0
            lowest = p[i, j, 0]
            negative = 0.0
            for k in range(n_alpha):
                value = p[i, j, k]
                total += value
                total_cosine += value * cosine[k]
                total_sine += value * sine[k]
                lowest = min(lowest, value)
                negative += max(-value, 0.0)
                padded[k + 3] = np.sqrt(max(value, 0.0))
            for k in range(3):
                padded[k] = padded[k + n_alpha]
            for k in range(5):
                padded[n_alpha + 3 + k] = padded[k + 3]
            out[i, j, 0] = total
            out[i, j, 1] = total_cosine
            out[i, j, 2] = total_sine
            out[i, j, 3] = squared_differences(padded, n_alpha)
            out[i, j, 4] = lowest
            out[i, j, 5] = negative


@njit(cache=True, parallel=True, fastmath={"contract"}, error_model="numpy")
def row_sums(p, out):
    """out[i, j] = Σ_k p[i, j, k]; p (n1, n2, n_alpha), out (n1, n2)."""
    n1, n2, n_alpha = p.shape
    for i in prange(n1):
        for j in range(n2):
            total = 0.0
            for k in range(n_alpha):
                total += p[i, j, k]
            out[i, j] = total


@njit(cache=True, parallel=True, fastmath={"contract"}, error_model="numpy")
def scale_rows(p, factor, out):
    """out[i, j, k] = factor[i, j] p[i, j, k]; p, out (n1, n2, n_alpha).

    Element by element, so `out` may be p itself. Results below the smallest normal
    number become zero: subnormal tails slow every later kernel several times.
    """
    n1, n2, n_alpha = p.shape
    for i in prange(n1):
        for j in range(n2):
            for k in range(n_alpha):
                value = factor[i, j] * p[i, j, k]
                out[i, j, k] = value if abs(value) > 1e-290 or value != value else 0.0
