"""Rotation and diffusion of the angle at fixed ξ, as small matrices in α-Fourier.

A batch of phase-space rows p[i, j, :] is transformed to Fourier modes, turned into
the frame of ∇B, multiplied by the matrix that belongs to its |∇B| and brought back.
The cosine and sine transforms act on the even and odd parts of a row, which halves
their cost. Batches have a fixed size, so that results do not depend on threads.
"""

import numpy as np
from numba import njit, prange

ROWS_PER_BATCH = 64


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def fold(p, rows, even, odd, sawtooth):
    """even, odd parts of p[rows[r], :] about α = 0 and its Nyquist amplitude.

    p (n_rows, n_alpha); rows (R,); even, odd (R, n_alpha/2); sawtooth (R,).
    """
    half = even.shape[1]
    n_alpha = 2 * half
    for r in range(rows.size):
        row = p[rows[r]]
        for k in range(half):
            even[r, k] = row[k] + row[n_alpha - 1 - k]
            odd[r, k] = row[k] - row[n_alpha - 1 - k]
        amplitude = 0.0
        sign = 1.0
        for k in range(half):
            amplitude += sign * odd[r, k]
            sign = -sign
        sawtooth[r] = amplitude / n_alpha


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def unfold(even, odd, sawtooth, rows, factor, out):
    """out[rows[r], :] = factor[r] · (even + odd + Nyquist part).

    even, odd (R, n_alpha/2); sawtooth, rows (R,); factor, by row of out (n_rows,).
    """
    half = even.shape[1]
    n_alpha = 2 * half
    for r in range(rows.size):
        row = out[rows[r]]
        scale = factor[rows[r]]
        ripple = sawtooth[r]
        for k in range(half):
            symmetric = even[r, k]
            skew = odd[r, k] + ripple
            row[k] = scale * (symmetric + skew)
            row[n_alpha - 1 - k] = scale * (symmetric - skew)
            ripple = -ripple


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def turn_in(cosine, sine, phases, rows, out):
    """out[r, (re, im), m] = (cosine + i sine)[r, m] rotated into the frame of ∇B.

    The mode is c_m = Σ p e^{−imα} = cosine − i sine, the phase e^{imφ}.
    cosine, sine (R, M); phases (n_rows, 2, M); out (R, 2, M).
    """
    for r in range(rows.size):
        c = phases[rows[r], 0]
        s = phases[rows[r], 1]
        for m in range(cosine.shape[1]):
            out[r, 0, m] = cosine[r, m] * c[m] + sine[r, m] * s[m]
            out[r, 1, m] = cosine[r, m] * s[m] - sine[r, m] * c[m]


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def turn_out(modes, phases, rows, cosine, sine):
    """The inverse of `turn_in`: modes (R, 2, M) back to cosine and sine (R, M)."""
    for r in range(rows.size):
        c = phases[rows[r], 0]
        s = phases[rows[r], 1]
        for m in range(cosine.shape[1]):
            cosine[r, m] = modes[r, 0, m] * c[m] + modes[r, 1, m] * s[m]
            sine[r, m] = modes[r, 0, m] * s[m] - modes[r, 1, m] * c[m]


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def multiply_groups(modes, matrix_of, matrices, out):
    """out[r] = modes[r] · matrices[matrix_of[r]]; equal neighbours in one product.

    modes, out (R, 2, M); matrix_of (R,), sorted; matrices (n_matrices, M, M).
    """
    n_rows, _, n_modes = modes.shape
    start = 0
    while start < n_rows:
        stop = start + 1
        while stop < n_rows and matrix_of[stop] == matrix_of[start]:
            stop += 1
        block = (2 * (stop - start), n_modes)
        np.dot(
            modes[start:stop].reshape(block),
            matrices[matrix_of[start]],
            out[start:stop].reshape(block),
        )
        start = stop


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def multiply_interpolated(modes, matrix_of, coefficients, matrices, out):
    """out[r] = Σ_q coefficients[r, q] modes[r] · matrices[q, matrix_of[r]].

    modes, out (R, 2, M); matrix_of (R,), sorted; coefficients (R, Q);
    matrices (Q, n_intervals, M, M).
    """
    n_rows, _, n_modes = modes.shape
    product = np.empty((n_rows, 2, n_modes))
    out[:] = 0.0
    for q in range(coefficients.shape[1]):
        multiply_groups(modes, matrix_of, matrices[q], product)
        for r in range(n_rows):
            for m in range(n_modes):
                out[r, 0, m] += coefficients[r, q] * product[r, 0, m]
                out[r, 1, m] += coefficients[r, q] * product[r, 1, m]


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
def rotate(
    p, rows, matrix_of, coefficients, matrices, phases, damping, factor,
    cosines, sines, inverse_cosines, inverse_sines, positive, out,
):  # fmt: skip
    """out[row] = factor · F⁻¹ e^{−imφ} M(|∇B|) e^{imφ} F p[row] for every row.

    p, out (n_rows, n_alpha); rows, matrix_of (n_rows,) sorted by matrix;
    coefficients (n_rows, Q); matrices (Q, n_intervals, M, M) with M = n_alpha/2,
    transposed (mode in, mode out); phases (n_rows, 2, M); damping: factor of the
    Nyquist mode; factor (n_rows,); transforms (M, M).
    """
    half = p.shape[1] // 2
    n_batches = (rows.size + ROWS_PER_BATCH - 1) // ROWS_PER_BATCH
    for batch in prange(n_batches):
        start = batch * ROWS_PER_BATCH
        stop = min(start + ROWS_PER_BATCH, rows.size)
        mine = rows[start:stop]
        shape = (stop - start, half)
        even, odd = np.empty(shape), np.empty(shape)
        cosine, sine = np.empty(shape), np.empty(shape)
        modes = np.empty((stop - start, 2, half))
        moved = np.empty((stop - start, 2, half))
        sawtooth = np.empty(stop - start)
        fold(p, mine, even, odd, sawtooth)
        np.dot(even, cosines, cosine)
        np.dot(odd, sines, sine)
        turn_in(cosine, sine, phases, mine, modes)
        if coefficients.shape[1] == 1:
            multiply_groups(modes, matrix_of[start:stop], matrices[0], moved)
        else:
            multiply_interpolated(
                modes, matrix_of[start:stop], coefficients[start:stop], matrices, moved
            )
        turn_out(moved, phases, mine, cosine, sine)
        np.dot(cosine, inverse_cosines, even)
        np.dot(sine, inverse_sines, odd)
        for r in range(stop - start):
            sawtooth[r] *= damping
        unfold(even, odd, sawtooth, mine, factor, out)
        if positive:
            for r in range(stop - start):
                limit_row(out[mine[r]])


@njit(cache=True, error_model="numpy")
def moebius_powers(a, n_modes, out):
    """out[m, n] = [zⁿ] ((z − a)/(1 − a z))^m: a point moved by the angle equation.

    With a = tanh(g t/2) the map e^{iθ} → (e^{iθ} − a)/(1 − a e^{iθ}) is the flow of
    dθ = g sin θ dt. out (n_modes, n_modes).
    """
    out[:] = 0.0
    out[0, 0] = 1.0
    for m in range(1, n_modes):
        out[m, 0] = -a * out[m - 1, 0]
        for n in range(1, n_modes):
            out[m, n] = a * out[m, n - 1] + out[m - 1, n - 1] - a * out[m - 1, n]


@njit(cache=True, parallel=True, error_model="numpy")
def rotation_matrices(openings, heat, balanced, out):
    """out[q] = R½ D R½ for a = openings[q], transposed: mode in, mode out.

    openings (n,); heat (M,) the damping of the modes; out (n, M, M). Balanced matrices
    act on h, the others on p.
    """
    n_modes = heat.size
    for q in prange(openings.size):
        rotation = np.empty((n_modes, n_modes))
        damped = np.empty((n_modes, n_modes))
        moebius_powers(-openings[q] if balanced else openings[q], n_modes, rotation)
        if balanced:
            # The mean of h hears a mode and its conjugate.
            for n in range(1, n_modes):
                rotation[n, 0] *= 2.0
        for m in range(n_modes):
            for n in range(n_modes):
                damped[m, n] = heat[m] * rotation[m, n]
        product = np.dot(rotation, damped)
        out[q] = product if balanced else product.T
