"""Linear systems whose matrix has few diagonals, by Gauss without pivoting."""

from fpsolve._kernels.compiling import njit
from fpsolve._kernels.lanes import LANES, fused, put, spread, take

__all__ = ["REACH", "solve_banded_rows"]

# Diagonals to either side of the main one: two times as many as lanes.
REACH = 2 * LANES


@njit(cache=True, error_model="numpy")
def solve_banded_rows(rows, known):
    """Solve in place for `known` (n,); `rows` is destroyed.

    rows (n, 17): row i from column i − 8 to i + 8; what lies outside of the matrix is
    not looked at. Without pivoting: exact to rounding where no leading block is nearly
    singular, as of matrices whose symmetric part is positive definite. A zero pivot
    leaves numbers that are not finite.
    """
    n = known.size
    for k in range(n - REACH):
        scale = -1.0 / rows[k, REACH]
        held = known[k]
        near, far = take(rows, (k, REACH + 1)), take(rows, (k, REACH + LANES + 1))
        for below in range(1, REACH + 1):
            row, first = k + below, REACH + 1 - below
            factor = rows[row, first - 1] * scale
            known[row] += factor * held
            times = spread(factor)
            put(rows, (row, first), fused(times, near, take(rows, (row, first))))
            first += LANES
            put(rows, (row, first), fused(times, far, take(rows, (row, first))))
        rows[k, REACH] = scale
    for k in range(max(n - REACH, 0), n):
        scale = -1.0 / rows[k, REACH]
        for below in range(1, n - k):
            row, first = k + below, REACH - below
            factor = rows[row, first] * scale
            known[row] += factor * known[k]
            for beside in range(1, n - k):
                rows[row, first + beside] += factor * rows[k, REACH + beside]
        rows[k, REACH] = scale
    _substitute(rows, known)


@njit(cache=True, error_model="numpy", forceinline=True)
def _substitute(rows, known):
    """From the last unknown to the first; the diagonal holds −1/pivot."""
    n = known.size
    for k in range(n - 1, -1, -1):
        found = 0.0
        # What has just been found comes last, so that little waits for it.
        for beside in range(min(REACH, n - 1 - k), 0, -1):
            found += rows[k, REACH + beside] * known[k + beside]
        known[k] = (found - known[k]) * rows[k, REACH]
