"""Velocities of a chain after some of its nodes have come to rest at once."""

import numpy as np

from fpsolve._kernels.compiling import njit

__all__ = ["arrest"]


@njit(cache=True, error_model="numpy")
def arrest(r, masses, held, v):
    """v ← v + M⁻¹ G^T λ, G v = 0: what a plastic impact leaves, the nearest in energy.

    G_i v = e_i·(v_{i+1} − v_i), the rate at which edge i would stretch. r and v have
    the shape (n + 1, 3); masses (n + 1,), held (n + 1,) bool: nodes whose velocity is
    given. Edges between two of these are left alone.
    """
    n = r.shape[0] - 1
    edges, diagonal, beside = r[1:] - r[:-1], np.empty(n), np.zeros(n)
    impulse = np.empty(n)
    for i in range(n):
        lightness = 0.0
        for j in range(i, i + 2):
            lightness += 0.0 if held[j] else 1.0 / masses[j]
        size, rate = 0.0, 0.0
        for c in range(3):
            size += edges[i, c] * edges[i, c]
            rate += edges[i, c] * (v[i + 1, c] - v[i, c])
        diagonal[i], impulse[i] = size * lightness, -rate
        if lightness == 0.0:
            diagonal[i], impulse[i] = 1.0, 0.0
        if i > 0 and not held[i]:
            for c in range(3):
                beside[i] -= edges[i, c] * edges[i - 1, c] / masses[i]
    # Symmetric and positive definite: no pivots.
    for i in range(1, n):
        factor = beside[i] / diagonal[i - 1]
        diagonal[i] -= factor * beside[i]
        impulse[i] -= factor * impulse[i - 1]
    for i in range(n - 1, -1, -1):
        if i < n - 1:
            impulse[i] -= beside[i + 1] * impulse[i + 1]
        impulse[i] /= diagonal[i]
    for i in range(n + 1):
        if held[i]:
            continue
        for c in range(3):
            before = impulse[i - 1] * edges[i - 1, c] if i > 0 else 0.0
            after = impulse[i] * edges[i, c] if i < n else 0.0
            v[i, c] += (before - after) / masses[i]
