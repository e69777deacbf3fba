"""Matrices of the angle step R½ D R½ in α-Fourier, one per value of |∇B|."""

import numpy as np
from numba import prange

from fpsolve._kernels.compiling import njit


@njit(cache=True, error_model="numpy")
def first_of_group(ordered, relative, absolute, out):
    """out[k]: value k exceeds the first of the group before it by more than allowed.

    ordered (n,), ascending, infinity included; allowed is the larger of `relative`
    times the first of the group and `absolute`. Groups do not grow by links: their
    width is bounded. out (n,), boolean.
    """
    first = -np.inf
    for k in range(ordered.size):
        # The first is one even where it is NaN: every value has a group.
        out[k] = k == 0 or ordered[k] > first + max(relative * first, absolute)
        if out[k]:
            first = ordered[k]


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
        # Value by value: to assign rows, numba would compile the text of its errors.
        for m in range(n_modes):
            for n in range(n_modes):
                out[q, m, n] = product[m, n] if balanced else product[n, m]
