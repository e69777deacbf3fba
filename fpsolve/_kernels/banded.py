"""Linear systems whose matrix has few diagonals, by Gauss with partial pivoting."""

from fpsolve._kernels.compiling import njit

__all__ = ["solve_banded_rows"]


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def solve_banded_rows(rows, known):
    """Solve in place for `known`; `rows` is destroyed.

    rows (n, 2 b + 1): row i from column max(0, i − b) on, for a matrix without entries
    further than b from its diagonal; entries beyond column n − 1 are 0. known (n,). A
    singular matrix leaves numbers that are not finite.
    """
    n, width = rows.shape
    reach = (width - 1) // 2
    for k in range(n):
        # Every row that is reached from here begins at column k.
        last = min(k + reach, n - 1)
        pivot = k
        for i in range(k + 1, last + 1):
            if abs(rows[i, 0]) > abs(rows[pivot, 0]):
                pivot = i
        if pivot != k:
            known[k], known[pivot] = known[pivot], known[k]
            for j in range(width):
                rows[k, j], rows[pivot, j] = rows[pivot, j], rows[k, j]
        first = rows[k]
        scale = 1.0 / first[0]
        for i in range(k + 1, last + 1):
            row = rows[i]
            factor = row[0] * scale
            known[i] -= factor * known[k]
            for j in range(1, width):
                row[j - 1] = row[j] - factor * first[j]
            row[width - 1] = 0.0
    for k in range(n - 1, -1, -1):
        found = known[k]
        for j in range(1, min(width, n - k)):
            found -= rows[k, j] * known[k + j]
        known[k] = found / rows[k, 0]
