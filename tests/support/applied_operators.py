"""Operators called for their result, and a kick made of full matrices."""

import numpy as np

from fpsolve.density.schemes import rotation_table


def applied(operator, p, s=0.3, ds=0.2):
    out = np.empty_like(p)
    operator(p, s, ds, out)
    return out


def kicked_by_full_matrices(kick, p, ds):
    """R½ D R½ row by row, with one Fourier matrix and one product for each."""
    n = p.shape[2]
    half, alpha = n // 2, kick.grid.alpha
    modes = np.exp(-1j * np.outer(np.arange(half), alpha))
    heat = np.exp(-kick.model.diffusivity * ds * np.arange(half + 1) ** 2)
    strength = np.hypot(*kick.force)
    out, ripple = np.empty_like(p), (-1.0) ** np.arange(n)
    for i, j in np.ndindex(*p.shape[:2]):
        phases = np.exp(1j * np.arange(half) * np.arctan2(*kick.force[::-1])[i, j])
        angles = rotation_table.opening(strength[i, j : j + 1], ds)
        matrix = rotation_table.matrices_at(angles, heat[:half], kick.balanced)[0]
        moved = ((modes @ p[i, j]) * phases) @ matrix / phases
        moved[1:] *= 2.0
        out[i, j] = (moved @ modes.conj()).real / n
        out[i, j] += heat[half] * (ripple @ p[i, j]) / n * ripple
    return out
