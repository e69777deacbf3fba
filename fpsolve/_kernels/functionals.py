"""Row functionals of a density: one pass over p leaves sums for every ξ.

Sums over ξ are left to numpy, so that they do not depend on threads.
"""

import numpy as np
from numba import prange
from numba.extending import register_jitable

from fpsolve._kernels.compiling import njit
from fpsolve._kernels.lanes import (
    LANES,
    fused,
    larger,
    mantissa_and_exponent,
    parts,
    put,
    root,
    smaller,
    spread,
    take,
)

# Staggered first difference of order eight: the weights of q[k+1+j] − q[k−j].
NEAR, NEXT, THIRD, FAR = 1225.0 / 1024.0, -245.0 / 3072.0, 49.0 / 5120.0, -5.0 / 7168.0

N_FUNCTIONALS = 7
# Rows whose roots are written before any of them is read: what has just been written
# in one place cannot be read in another without waiting.
ROWS_TOGETHER = 4

# Arguments of the logarithm: normal numbers, far below what carries mass.
SMALLEST = 1e-300
LN2 = 6.93147180559945286227e-01
# ln((1 + s)/(1 − s)) = 2s + s R(s²), |s| ≤ 0.1716: minimax polynomial, error 2⁻⁵⁸,
# of Sun's fdlibm.
R1, R2, R3, R4, R5, R6, R7 = (
    6.666666666666735130e-01, 3.999999999940941908e-01, 2.857142874366239149e-01,
    2.222219843214978396e-01, 1.818357216161805012e-01, 1.531383769920937332e-01,
    1.479819860511658591e-01,
)  # fmt: skip

# Helpers that are called for every row become part of it: handing over six arrays takes
# as long as a quarter of a row does.


@register_jitable(fastmath={"contract"}, error_model="numpy", forceinline=True)
def logarithm(x):
    """ln x of four positive normal numbers, to two units in the last place.

    x = 2^e m with m in [√½, √2), and ln m by the polynomial of fdlibm: four at once,
    which a call of a library's logarithm is not.
    """
    m, e = mantissa_and_exponent(x)
    one = spread(1.0)
    f = m - one
    s = f / (m + one)
    z = s * s
    w = z * z
    even = w * (spread(R2) + w * (spread(R4) + w * spread(R6)))
    odd = spread(R1) + w * (spread(R3) + w * (spread(R5) + w * spread(R7)))
    # f is exact, and s (f − R) at most a fifth of it.
    return e * spread(LN2) + (f - s * (f - fused(z, odd, even)))


@register_jitable(fastmath={"contract"}, error_model="numpy", forceinline=True)
def summed(lanes):
    """Sum of four lanes, in pairs."""
    a, b, c, d = parts(lanes)
    return (a + b) + (c + d)


@njit(cache=True, fastmath={"contract"}, error_model="numpy", forceinline=True)
def squared_differences(padded, ones):
    """Σ_k (δq)²_{k+½} with the staggered eighth-order difference δ, unit spacing.

    padded (N + 7,): q periodic with three cells before and four behind; ones (N,) is
    zero for cells that are not counted, N a multiple of four.
    """
    total = spread(0.0)
    for k in range(0, ones.size, LANES):
        slope = spread(NEAR) * (take(padded, (k + 4,)) - take(padded, (k + 3,)))
        difference = take(padded, (k + 5,)) - take(padded, (k + 2,))
        slope = fused(spread(NEXT), difference, slope)
        difference = take(padded, (k + 6,)) - take(padded, (k + 1,))
        slope = fused(spread(THIRD), difference, slope)
        difference = take(padded, (k + 7,)) - take(padded, (k,))
        slope = fused(spread(FAR), difference, slope)
        total = total + take(ones, (k,)) * slope * slope
    return summed(total)


@njit(cache=True, fastmath={"contract"}, error_model="numpy", forceinline=True)
def read_row(row, cosine, sine, ones, inverse, roots, out):
    """out = Σ p, Σ p cos α, Σ p sin α, 0, min p, Σ max(−p, 0), Σ p ln q of a row.

    All rows (N,), N a multiple of four; q = p inverse, and no logarithms for
    inverse = 0. roots[k + 3] = √max(p, 0) is left for what follows.
    """
    total = total_cosine = total_sine = negative = information = spread(0.0)
    zero, scale, smallest = spread(0.0), spread(inverse), spread(SMALLEST)
    lowest = take(row, (0,))
    for k in range(0, row.size, LANES):
        p, counted = take(row, (k,)), take(ones, (k,))
        below = smaller(p, zero)
        above = p - below
        total = total + counted * p
        total_cosine = total_cosine + take(cosine, (k,)) * p
        total_sine = total_sine + take(sine, (k,)) * p
        negative = negative - counted * below
        lowest = smaller(lowest, p)
        put(roots, (k + 3,), root(above))
        if inverse > 0.0:
            q = logarithm(larger(above * scale, smallest))
            information = information + counted * above * q
    a, b, c, d = parts(lowest)
    out[0], out[1], out[2] = summed(total), summed(total_cosine), summed(total_sine)
    out[3], out[4] = 0.0, min(min(a, b), min(c, d))
    out[5], out[6] = summed(negative), summed(information)


@njit(cache=True, error_model="numpy", forceinline=True)
def make_periodic(padded, n):
    """padded[3 : n + 3] holds a period: the same before (3 cells) and behind (5)."""
    for k in range(3):
        padded[k] = padded[k + n]
    for k in range(5):
        padded[n + 3 + k] = padded[k + 3]


@njit(cache=True, parallel=True, fastmath={"contract"}, error_model="numpy")
def row_functionals(p, cosine, sine, inverse, out):
    """out[:, i, j] = Σ_k of p, p cos α, p sin α, (δ√p)², min_k p, Σ max(−p, 0), p ln q.

    p (n1, n2, n_alpha); cosine, sine (n_alpha,); q = p inverse with inverse (n1, n2),
    or (1, 1) for no logarithms; out (7, n1, n2). Negative values count as zero under
    the root and in p ln q.
    """
    n1, n2, n_alpha = p.shape
    n = n_alpha + (-n_alpha) % LANES
    # Rows are extended to full registers by cells of weight zero.
    weights = np.zeros((3, n))
    weights[0, :n_alpha], weights[1, :n_alpha] = cosine, sine
    weights[2, :n_alpha] = 1.0
    for i in prange(n1):
        row, sums = np.empty(n), np.empty(N_FUNCTIONALS)
        # What is beyond a period is read with weight zero: it must not be NaN.
        roots = np.zeros((ROWS_TOGETHER, n + 8))
        for first in range(0, n2, ROWS_TOGETHER):
            last = min(first + ROWS_TOGETHER, n2)
            for j in range(first, last):
                for k in range(n_alpha):
                    row[k] = p[i, j, k]
                for k in range(n_alpha, n):
                    row[k] = row[0]
                scale = inverse[i, j] if inverse.size > 1 else 0.0
                read_row(
                    row, weights[0], weights[1], weights[2], scale, roots[j - first],
                    sums,
                )  # fmt: skip
                make_periodic(roots[j - first], n_alpha)
                for c in range(N_FUNCTIONALS):
                    out[c, i, j] = sums[c]
            for j in range(first, last):
                out[3, i, j] = squared_differences(roots[j - first], weights[2])


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
