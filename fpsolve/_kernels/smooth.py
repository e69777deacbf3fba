"""The curvature of a smooth fibre: what the force and its own relaxation do to it.

Densities are held as u[row, c, k], row a point ξ, c a real Fourier mode in κ, k an
angle: mode 0 is the sum over κ, modes 2j − 1 and 2j are cosine and sine of jκ, and
where their number is even the last is the sum with alternating signs.
"""

import numpy as np
from numba import prange

from fpsolve._kernels.compiling import njit

# Rows that are multiplied together; fixed, so that results do not depend on threads.
ROWS_TOGETHER = 8


@njit(cache=True, error_model="numpy")
def turn_modes(modes, angle, out):
    """out[c, k] = modes[c, k] of a density that is moved by angle[k] in κ.

    modes, out (C, n); the period of κ is 2π; `out` may be `modes`.
    """
    n_modes, n = modes.shape
    cosine, sine = np.cos(angle), np.sin(angle)
    c, s = cosine.copy(), sine.copy()
    for k in range(n):
        out[0, k] = modes[0, k]
    for first in range(1, n_modes - 1, 2):
        for k in range(n):
            a, b = modes[first, k], modes[first + 1, k]
            out[first, k] = a * c[k] - b * s[k]
            out[first + 1, k] = b * c[k] + a * s[k]
            ahead = c[k] * cosine[k] - s[k] * sine[k]
            s[k] = s[k] * cosine[k] + c[k] * sine[k]
            c[k] = ahead
    if n_modes % 2 == 0:
        for k in range(n):
            out[n_modes - 1, k] = modes[n_modes - 1, k] * c[k]


@njit(cache=True, parallel=True, error_model="numpy")
def kick(u, force1, force2, cosines, sines, length, out):
    """∂ₛp + (F/R) ∂_κ p = 0, F = −∇B·τ⊥(α): κ moves by `length` · F at fixed ξ, α.

    u, out (n_rows, C, n), `out` may be u; force1, force2 (n_rows,), the gradient of B;
    cosines, sines (n,) of the angles; length in units in which the period of κ is 2π.
    """
    for row in prange(u.shape[0]):
        angle = length * (force1[row] * sines - force2[row] * cosines)
        turn_modes(u[row], angle, out[row])


@njit(cache=True, parallel=True, error_model="numpy")
def mix(u, forward, matrices, backward, out):
    """One matrix in κ for every Fourier mode in α.

    u (n_rows, C, n), out (n_rows, D, n); forward (n, 2M) to cosine and minus sine of
    mode m in columns 2m and 2m + 1; matrices (M, 2C, 2D) for real parts of all c, then
    imaginary parts; backward (2M, n).
    """
    n_rows, n_in, n = u.shape
    n_out = out.shape[1]
    n_modes = matrices.shape[0]
    for batch in prange((n_rows + ROWS_TOGETHER - 1) // ROWS_TOGETHER):
        first = batch * ROWS_TOGETHER
        size = min(ROWS_TOGETHER, n_rows - first)
        source = u[first : first + size].copy().reshape(size * n_in, n)
        modes = np.dot(source, forward)
        moved = np.empty((size * n_out, 2 * n_modes))
        parts = np.empty((size, 2 * n_in))
        for m in range(n_modes):
            for r in range(size):
                for c in range(n_in):
                    parts[r, c] = modes[r * n_in + c, 2 * m]
                    parts[r, n_in + c] = modes[r * n_in + c, 2 * m + 1]
            mixed = np.dot(parts, matrices[m])
            for r in range(size):
                for c in range(n_out):
                    moved[r * n_out + c, 2 * m] = mixed[r, c]
                    moved[r * n_out + c, 2 * m + 1] = mixed[r, n_out + c]
        result = np.dot(moved, backward)
        for r in range(size):
            for c in range(n_out):
                for k in range(n):
                    out[first + r, c, k] = result[r * n_out + c, k]


@njit(cache=True, parallel=True, error_model="numpy")
def curvature_sums(p, kappa, marginal, rows):
    """marginal[r, k] = Σ_l p[r, k, l], and sums over k and l for every row.

    p (n_rows, n, n_kappa); marginal (n_rows, n); rows (6, n_rows): Σ κ p, Σ κ² p,
    Σ |p|, Σ |p| of the first and last κ, Σ max(−p, 0), min p.
    """
    n_rows, n, n_kappa = p.shape
    last = n_kappa - 1
    for r in prange(n_rows):
        first_moment = second_moment = magnitude = edges = negative = 0.0
        lowest = p[r, 0, 0]
        for k in range(n):
            total = 0.0
            for j in range(n_kappa):
                value = p[r, k, j]
                total += value
                first_moment += kappa[j] * value
                second_moment += kappa[j] * kappa[j] * value
                magnitude += abs(value)
                negative += max(-value, 0.0)
                lowest = min(lowest, value)
            edges += abs(p[r, k, 0]) + abs(p[r, k, last])
            marginal[r, k] = total
        rows[0, r], rows[1, r] = first_moment, second_moment
        rows[2, r], rows[3, r] = magnitude, edges
        rows[4, r], rows[5, r] = negative, lowest
