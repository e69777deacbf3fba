"""Anderson's combination of the last corrections of a fixed-point iteration."""

from __future__ import annotations

import numpy as np

from fpsolve._support.arrays import Array

__all__ = ["Acceleration"]

DEPTH = 10


class Acceleration:
    """p ← Σ_j θ_j (p_j + d_j), Σ θ_j = 1, with the smallest Σ_j θ_j d_j.

    For a linear problem this is GMRES with the correction as a preconditioner: a
    direction of which a correction removes little is found from a few of them.

    References
    ----------
    [And65]_.
    """

    def __init__(self) -> None:
        self.densities: list[Array] = []
        self.corrections: list[Array] = []

    def __call__(self, p: Array, correction: Array) -> Array:
        """The next density, from this one, its correction and those before."""
        self.densities.append(p)
        self.corrections.append(correction)
        del self.densities[:-DEPTH], self.corrections[:-DEPTH]
        best = p + correction
        if len(self.densities) == 1:
            return best
        changes = [correction - one for one in self.corrections[:-1]]
        matrix = np.array([[np.vdot(a, b) for b in changes] for a in changes])
        right = np.array([np.vdot(a, correction) for a in changes])
        theta = np.linalg.lstsq(matrix, right, rcond=1e-12)[0]
        for weight, change, density in zip(
            theta, changes, self.densities[:-1], strict=True
        ):
            best -= weight * (p - density + change)
        return best
