"""Sums of circular Hermite functions on rings, and the integrand of the entropy."""

from fpsolve._kernels.compiling import njit
from fpsolve._kernels.functionals import SMALLEST, logarithm
from fpsolve._kernels.lanes import LANES, fused, larger, put, spread, take

# Below, 1 + u loses digits of (1 + u) ln(1 + u) − u, which nine terms of its series
# give to 1e-19.
NEAR_ONE, TERMS = 1e-2, 10


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def sums_on_rings(c, counts, index, functions, out):
    """out[part, row, r] = Σ_m c[part, row, 1 + m] functions[|l|, m, r], l = M − k.

    c (2, R, W), counts (R,), functions (., ., n) and out (2, R, n), n a multiple of 4.
    """
    harmonics = (counts.size - 3) // 2
    for row in range(1, counts.size - 1):
        turns = abs(index - row + 1 + harmonics)
        for r in range(0, functions.shape[2], LANES):
            real, imaginary = spread(0.0), spread(0.0)
            for m in range(counts[row]):
                value = take(functions, (turns, m, r))
                real = fused(spread(c[0, row, m + 1]), value, real)
                imaginary = fused(spread(c[1, row, m + 1]), value, imaginary)
            put(out, (0, row, r), real)
            put(out, (1, row, r), imaginary)


@njit(cache=True, error_model="numpy")
def sums_at_points(waves, ring, turn, out):
    """out[p, k] = Σ_M waves[ring[p], M, k] turn[p]^M, M = 0 … last, by Horner.

    waves (n_rings, n_sectors, n), out (n_points, n); ring and turn (n_points,).
    """
    for p in range(ring.size):
        for k in range(out.shape[1]):
            out[p, k] = 0.0
        for index in range(waves.shape[1] - 1, -1, -1):
            for k in range(out.shape[1]):
                out[p, k] = out[p, k] * turn[p] + waves[ring[p], index, k]


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def entropy_integrand(excess, lowest, out):
    """out = (1 + u) ln(1 + u) − u, without cancellation, and 1 below −1.

    excess (n,), n a multiple of four, is left as ln max(1 + u, lowest).
    """
    one, floor, least = spread(1.0), spread(SMALLEST), spread(lowest)
    for i in range(0, excess.size, LANES):
        u = larger(take(excess, (i,)), spread(-1.0))
        value = larger(one + u, floor)
        put(out, (i,), value * logarithm(value) - u)
        for j in range(i, i + LANES):
            if abs(excess[j]) < NEAR_ONE:
                series = 0.0
                for n in range(TERMS, 1, -1):
                    series = series * excess[j] + (1.0 - 2.0 * (n % 2)) / (n * (n - 1))
                out[j] = series * excess[j] ** 2
        put(excess, (i,), logarithm(larger(value, least)))
