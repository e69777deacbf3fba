"""(I − E)⁻¹ of a stride E by a Krylov iteration that remembers slow directions."""

from __future__ import annotations

from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.density.stationary.strides import Stride

__all__ = ["Correction"]


# Directions of one cycle, cycles of one solution, and directions that are remembered:
# those in which a stride changes least.
CYCLE, CYCLES, REMEMBERED = 20, 2, 10
# Size of the disturbance by which E is differentiated, relative to the density.
DISTURBANCE = 0.1
# Mass relative to the size of a right-hand side that does not matter.
TRACE = 1e-6


class Correction:
    """d with (I − E) d = r, for one right-hand side after another (GCROT).

    E is the stride of a scheme, linear but for the rounding of its mass; what it does
    to a direction is the difference to what it does to one density.

    Parameters
    ----------
    evolution : Stride
    base, image : ndarray, shape (n1, n2, n_alpha)
        A density and what the stride makes of it.

    References
    ----------
    The iteration is that of [HZ10]_ (scipy).
    """

    def __init__(self, evolution: Stride, base: Array, image: Array) -> None:
        self.evolution, self.base, self.image = evolution, base, image
        self.size = float(np.abs(base).sum())
        self.remembered: list[Any] = []

    def __call__(self, r: Array, rtol: float) -> Array:
        """The correction d, with a residual of `rtol` relative to r in the l2 norm."""
        from scipy.sparse.linalg import LinearOperator, gcrotmk

        r = self._without_mass(r)
        n = r.size
        operator = LinearOperator((n, n), matvec=self._lost, dtype=np.float64)
        d, _ = gcrotmk(
            operator, r.ravel(), rtol=rtol, atol=0.0, maxiter=CYCLES,
            m=CYCLE, k=REMEMBERED, CU=self.remembered, discard_C=False,
            truncate="smallest",
        )  # fmt: skip
        corrected: Array = d.reshape(r.shape)
        return corrected

    @property
    def amplification(self) -> float:
        """Largest ‖d‖/‖r‖ seen: an estimate from below of ‖(I − E)⁻¹‖."""
        seen = [
            float(np.linalg.norm(u) / np.linalg.norm(c))
            for c, u in self.remembered
            if c is not None and np.any(c)
        ]
        return max(seen, default=1.0)

    def _without_mass(self, r: Array) -> Array:
        """r less the mass in it, where that is more than a trace of it.

        A stride keeps mass, so that no d leads to any: of a defect that is rounding,
        as after a long stride, the mass would be divided by rounding.
        """
        mass = float(r.sum())
        if abs(mass) <= TRACE * float(np.abs(r).sum()):
            return r
        without: Array = r - self.base * (mass / float(self.base.sum()))
        return without

    def _lost(self, direction: Array) -> Array:
        size = float(np.abs(direction).sum())
        if size == 0.0:
            return direction
        scale = DISTURBANCE * self.size / size
        moved = self.evolution(self.base + scale * direction.reshape(self.base.shape))
        lost: Array = direction - (moved - self.image).ravel() / scale
        return lost
