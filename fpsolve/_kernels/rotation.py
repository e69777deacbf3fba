"""Rotation and diffusion of the angle at fixed ξ, as small matrices in α-Fourier.

Four phase-space rows p[i, j, :] with the same matrix stand side by side in a register
(a quad), and a few quads make a batch. Their rows are folded about α = 0 and about
α = π/2, which leaves even and odd modes to cosine and sine matrices of a quarter of
the size; turned into the frame of ∇B; multiplied by the matrix of their |∇B|; and
brought back. Batches have a fixed size, so that results do not depend on threads.
"""

from typing import NamedTuple

import numpy as np
from numba import prange

from fpsolve._kernels.compiling import njit
from fpsolve._kernels.lanes import LANES, fused, put, spread, take, transposed

QUADS_PER_BATCH = 4
ROWS_PER_BATCH = LANES * QUADS_PER_BATCH
BATCHES_PER_CHUNK = 4


class RotationTable(NamedTuple):
    """Rows in quads of equal |∇B|, and M(|∇B|) = R½ D R½ for them.

    Attributes
    ----------
    rows : ndarray of int, shape (4 n_quads,)
        Row numbers in the order of |∇B|; four at a time share a matrix. Where there
        are not four, the last is repeated: in one batch, as the rotation is in place.
    matrix_of : ndarray of int, shape (n_quads,)
        Which matrix, or which interval of interpolation.
    coefficients : ndarray, shape (n_quads, Q, 4)
        Interpolation weights of the rows of a quad; Q = 1 for exact matrices.
    matrices : ndarray, shape (Q, n_intervals, M, M)
        Mode in, mode out; M = n_alpha/2.
    damping : float
        Factor of the Nyquist mode.
    """

    rows: np.ndarray
    matrix_of: np.ndarray
    coefficients: np.ndarray
    matrices: np.ndarray
    damping: float

    @property
    def nbytes(self) -> int:
        """Memory of the matrices, the largest part."""
        return self.matrices.nbytes


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def multiply(matrix, source, column, add, out):
    """out[n, c] = Σ_m matrix[m, n] source[m, c], c = column, …, column + 7.

    matrix (n_in, n_out); source (n_in, C); out (n_out, C). Added to `out` if `add`.
    """
    n_in, n_out = matrix.shape
    beside = column + LANES
    whole = n_out - n_out % 4
    for n in range(0, whole, 4):
        a0 = a1 = a2 = a3 = b0 = b1 = b2 = b3 = spread(0.0)
        if add:
            a0, b0 = take(out, (n, column)), take(out, (n, beside))
            a1, b1 = take(out, (n + 1, column)), take(out, (n + 1, beside))
            a2, b2 = take(out, (n + 2, column)), take(out, (n + 2, beside))
            a3, b3 = take(out, (n + 3, column)), take(out, (n + 3, beside))
        for m in range(n_in):
            a, b = take(source, (m, column)), take(source, (m, beside))
            entry = spread(matrix[m, n])
            a0, b0 = a0 + entry * a, b0 + entry * b
            entry = spread(matrix[m, n + 1])
            a1, b1 = a1 + entry * a, b1 + entry * b
            entry = spread(matrix[m, n + 2])
            a2, b2 = a2 + entry * a, b2 + entry * b
            entry = spread(matrix[m, n + 3])
            a3, b3 = a3 + entry * a, b3 + entry * b
        put(out, (n, column), a0)
        put(out, (n, beside), b0)
        put(out, (n + 1, column), a1)
        put(out, (n + 1, beside), b1)
        put(out, (n + 2, column), a2)
        put(out, (n + 2, beside), b2)
        put(out, (n + 3, column), a3)
        put(out, (n + 3, beside), b3)
    for n in range(whole, n_out):
        a0 = b0 = spread(0.0)
        if add:
            a0, b0 = take(out, (n, column)), take(out, (n, beside))
        for m in range(n_in):
            entry = spread(matrix[m, n])
            a0 = a0 + entry * take(source, (m, column))
            b0 = b0 + entry * take(source, (m, beside))
        put(out, (n, column), a0)
        put(out, (n, beside), b0)


@njit(cache=True, error_model="numpy")
def load_rows(p, rows, values):
    """values[k, r] = p[rows[r], k]; p (n_rows, n_alpha), rows (R,), values (., R)."""
    n_alpha = p.shape[1]
    for r in range(0, rows.size, LANES):
        for angles in range(0, n_alpha, LANES):
            k = min(angles, n_alpha - LANES)
            a, b, c, d = transposed(
                take(p, (rows[r], k)), take(p, (rows[r + 1], k)),
                take(p, (rows[r + 2], k)), take(p, (rows[r + 3], k)),
            )  # fmt: skip
            put(values, (k, r), a)
            put(values, (k + 1, r), b)
            put(values, (k + 2, r), c)
            put(values, (k + 3, r), d)


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def store_rows(values, rows, factor, out):
    """out[rows[r], k] = factor[rows[r]] values[k, r]; the inverse of `load_rows`.

    values (n_alpha, R); rows (R,); factor (n_rows,); out (n_rows, n_alpha).
    """
    n_alpha = out.shape[1]
    for r in range(0, rows.size, LANES):
        first, second, third, fourth = rows[r], rows[r + 1], rows[r + 2], rows[r + 3]
        for angles in range(0, n_alpha, LANES):
            k = min(angles, n_alpha - LANES)
            a, b, c, d = transposed(
                take(values, (k, r)), take(values, (k + 1, r)),
                take(values, (k + 2, r)), take(values, (k + 3, r)),
            )  # fmt: skip
            put(out, (first, k), spread(factor[first]) * a)
            put(out, (second, k), spread(factor[second]) * b)
            put(out, (third, k), spread(factor[third]) * c)
            put(out, (fourth, k), spread(factor[fourth]) * d)


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def fold(values, folded, sawtooth):
    """Parts of the rows that even and odd cosines and sines see, and the Nyquist part.

    values (n_alpha, R). folded[0] is even about α = 0 (cosines), folded[1] odd
    (sines); the second index is the parity of the modes, which is the symmetry about
    α = π/2; shape (2, 2, H, R) with H quarter-circle angles. sawtooth (R,) is the
    amplitude of (−1)^k.
    """
    n_alpha, n_rows = values.shape
    half, quarter = n_alpha // 2, folded.shape[2]
    for r in range(0, n_rows, LANES):
        ripple = spread(0.0)
        for k in range(quarter):
            mirror = half - 1 - k
            a, b = take(values, (k, r)), take(values, (n_alpha - 1 - k, r))
            c, d = take(values, (mirror, r)), take(values, (half + k, r))
            even, odd = a + b, a - b
            even_mirror, odd_mirror = c + d, c - d
            sign = spread(1.0 - 2.0 * (k % 2))
            if k == mirror:
                # α = π/2 is its own mirror image.
                even_mirror = odd_mirror = spread(0.0)
            ripple = ripple + sign * odd
            ripple = ripple + spread(1.0 - 2.0 * (mirror % 2)) * odd_mirror
            put(folded, (0, 0, k, r), even + even_mirror)
            put(folded, (0, 1, k, r), even - even_mirror)
            put(folded, (1, 0, k, r), odd - odd_mirror)
            put(folded, (1, 1, k, r), odd + odd_mirror)
        put(sawtooth, (r,), ripple * spread(1.0 / n_alpha))


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def unfold(folded, sawtooth, values):
    """Rows from their parts and (−1)^k sawtooth; shapes as in `fold`."""
    n_alpha, n_rows = values.shape
    half, quarter = n_alpha // 2, folded.shape[2]
    for r in range(0, n_rows, LANES):
        amplitude = take(sawtooth, (r,))
        for k in range(quarter):
            mirror = half - 1 - k
            a, b = take(folded, (0, 0, k, r)), take(folded, (0, 1, k, r))
            c, d = take(folded, (1, 0, k, r)), take(folded, (1, 1, k, r))
            even, even_mirror = a + b, a - b
            odd = d + c + spread(1.0 - 2.0 * (k % 2)) * amplitude
            odd_mirror = d - c + spread(1.0 - 2.0 * (mirror % 2)) * amplitude
            put(values, (mirror, r), even_mirror + odd_mirror)
            put(values, (half + k, r), even_mirror - odd_mirror)
            put(values, (k, r), even + odd)
            put(values, (n_alpha - 1 - k, r), even - odd)


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def transform(matrices, source, out):
    """The four cosine and sine products; matrices (2, 2, H, H), others (2, 2, H, R)."""
    for part in range(2):
        for parity in range(2):
            for column in range(0, source.shape[3], 2 * LANES):
                multiply(
                    matrices[part, parity], source[part, parity], column, False,
                    out[part, parity],
                )  # fmt: skip


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def powers(direction, rows, phases):
    """phases[:, m, r] = cos mφ, sin mφ with φ the direction of ∇B in rows[r].

    direction (2, n_rows) holds cos φ, sin φ; rows (R,); phases (2, M, R).
    """
    n_modes, n_rows = phases.shape[1:]
    for r in range(n_rows):
        phases[0, 0, r], phases[1, 0, r] = 1.0, 0.0
        phases[0, 1, r], phases[1, 1, r] = direction[0, rows[r]], direction[1, rows[r]]
    for m in range(2, n_modes):
        for r in range(0, n_rows, LANES):
            c, s = take(phases, (0, 1, r)), take(phases, (1, 1, r))
            real, imaginary = take(phases, (0, m - 1, r)), take(phases, (1, m - 1, r))
            put(phases, (0, m, r), fused(real, c, -(imaginary * s)))
            put(phases, (1, m, r), fused(real, s, imaginary * c))


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def turn_in(spectrum, phases, modes):
    """Modes c_m = Σ p e^{−imα} = cosine − i sine times e^{imφ}: the frame of ∇B.

    spectrum (2, 2, H, R), mode m at [:, m % 2, m // 2]; phases (2, M, R);
    modes (M, 2R): real and imaginary parts of a quad side by side.
    """
    for m in range(modes.shape[0]):
        for r in range(0, phases.shape[2], LANES):
            c, s = take(phases, (0, m, r)), take(phases, (1, m, r))
            cosine = take(spectrum, (0, m % 2, m // 2, r))
            sine = take(spectrum, (1, m % 2, m // 2, r))
            put(modes, (m, 2 * r), fused(cosine, c, sine * s))
            put(modes, (m, 2 * r + LANES), fused(cosine, s, -(sine * c)))


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def turn_out(modes, phases, spectrum):
    """The inverse of `turn_in`."""
    for m in range(modes.shape[0]):
        for r in range(0, phases.shape[2], LANES):
            c, s = take(phases, (0, m, r)), take(phases, (1, m, r))
            real, imaginary = take(modes, (m, 2 * r)), take(modes, (m, 2 * r + LANES))
            put(spectrum, (0, m % 2, m // 2, r), fused(real, c, imaginary * s))
            put(spectrum, (1, m % 2, m // 2, r), fused(real, s, -(imaginary * c)))


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def kick_quads(modes, matrix_of, coefficients, matrices, weighted, out):
    """out[:, r] = Σ_q coefficients[q, r] matrices[q, matrix_of[r]]ᵀ modes[:, r].

    modes, out, weighted (M, 2R); matrix_of (R/4,), one matrix for each quad;
    coefficients (R/4, Q, 4); matrices (Q, n_intervals, M, M), mode in, mode out.
    """
    n_nodes = coefficients.shape[1]
    for quad in range(matrix_of.size):
        column = 2 * LANES * quad
        if n_nodes == 1:
            multiply(matrices[0, matrix_of[quad]], modes, column, False, out)
            continue
        for q in range(n_nodes):
            weight = take(coefficients, (quad, q, 0))
            for m in range(modes.shape[0]):
                for c in range(column, column + 2 * LANES, LANES):
                    put(weighted, (m, c), weight * take(modes, (m, c)))
            multiply(matrices[q, matrix_of[quad]], weighted, column, q > 0, out)


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def limit_row(row):
    """Zhang-Shu: row ← mean + θ (row − mean), θ the largest in [0, 1] with row ≥ 0.

    Keeps the row's sum; a row whose mean is not positive is left as it is.
    """
    n_alpha = row.size
    mean = 0.0
    lowest = row[0]
    for k in range(n_alpha):
        mean += row[k]
        lowest = min(lowest, row[k])
    mean /= n_alpha
    if lowest < 0.0 and mean > 0.0:
        theta = mean / (mean - lowest)
        for k in range(n_alpha):
            row[k] = max(mean + theta * (row[k] - mean), 0.0)


@njit(cache=True, parallel=True, fastmath={"contract"}, error_model="numpy")
def rotate(p, table, direction, transforms, factor, positive, out):
    """out[row] = factor · F⁻¹ e^{−imφ} M(|∇B|) e^{imφ} F p[row] for every row.

    p, out (n_rows, n_alpha), which may be the same; table a `RotationTable`; direction
    (2, n_rows); transforms: F and F⁻¹, each (2, 2, H, H); factor (n_rows,).
    """
    rows, matrix_of, coefficients, matrices, damping = table
    forward, backward = transforms
    n_alpha = p.shape[1]
    half = n_alpha // 2
    quarter = forward.shape[2]
    n_batches = matrix_of.size // QUADS_PER_BATCH
    n_chunks = (n_batches + BATCHES_PER_CHUNK - 1) // BATCHES_PER_CHUNK
    for chunk in prange(n_chunks):
        values = np.empty((n_alpha, ROWS_PER_BATCH))
        folded = np.empty((2, 2, quarter, ROWS_PER_BATCH))
        spectrum = np.zeros((2, 2, quarter, ROWS_PER_BATCH))
        phases = np.empty((2, half, ROWS_PER_BATCH))
        modes = np.empty((half, 2 * ROWS_PER_BATCH))
        moved = np.empty((half, 2 * ROWS_PER_BATCH))
        weighted = np.empty((half, 2 * ROWS_PER_BATCH))
        sawtooth = np.empty(ROWS_PER_BATCH)
        last = min((chunk + 1) * BATCHES_PER_CHUNK, n_batches)
        for batch in range(chunk * BATCHES_PER_CHUNK, last):
            start, stop = batch * QUADS_PER_BATCH, (batch + 1) * QUADS_PER_BATCH
            mine = rows[LANES * start : LANES * stop]
            load_rows(p, mine, values)
            fold(values, folded, sawtooth)
            transform(forward, folded, spectrum)
            powers(direction, mine, phases)
            turn_in(spectrum, phases, modes)
            kick_quads(
                modes, matrix_of[start:stop], coefficients[start:stop], matrices,
                weighted, moved,
            )  # fmt: skip
            turn_out(moved, phases, spectrum)
            transform(backward, spectrum, folded)
            for r in range(ROWS_PER_BATCH):
                sawtooth[r] *= damping
            unfold(folded, sawtooth, values)
            store_rows(values, mine, factor, out)
            if positive:
                for r in range(ROWS_PER_BATCH):
                    limit_row(out[mine[r]])
