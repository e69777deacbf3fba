"""A density as coefficients of p/p_S, and which of them are kept."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fpsolve._kernels.ladder import shell_energies
from fpsolve._support.arrays import Array, Complex

__all__ = ["Expansion", "Limits", "spread"]

# limits[n] is the last harmonic kept at the degrees i + j = n; −1 where none is.
Limits = NDArray[np.int64]
ROOM = 30


@dataclass(frozen=True, eq=False)
class Expansion:
    """p/p_S = Σ i^j d[i, j, k] He_i(ξ1/σ1) He_j(ξ2/σ2) e^{ikα}, orthonormal in L²(μ).

    Only k ≥ 0 is held, since p is real. In this phase the forward equation is real.

    Attributes
    ----------
    values : ndarray, shape (n + 2, n + 2, 2 m + 4)
        Real and imaginary parts of d side by side; zero outside the limits.
    limits : ndarray of int, shape (n + 1,)
        Last harmonic kept at each degree i + j, at most m.
    """

    values: Array
    limits: Limits

    @classmethod
    def empty(cls, limits: Limits) -> Expansion:
        """Zero coefficients within limits; degrees without harmonics are cut off."""
        kept = np.flatnonzero(limits >= 0)
        limits = limits[: kept[-1] + 1] if kept.size else np.zeros(1, np.int64)
        degree, harmonics = limits.size - 1, int(limits.max())
        shape = degree + 2, degree + 2, 2 * harmonics + 4
        return cls(np.zeros(shape), np.ascontiguousarray(limits, np.int64))

    @property
    def degree(self) -> int:
        """Largest degree i + j."""
        return self.limits.size - 1

    @property
    def harmonics(self) -> int:
        """Largest k."""
        return int(self.limits.max())

    @property
    def n_coefficients(self) -> int:
        """Complex coefficients with k ≥ 0."""
        return int(np.sum((np.arange(self.limits.size) + 1) * (self.limits + 1)))

    @property
    def complex_values(self) -> Complex:
        """d[i, j, k], shape (n + 1, n + 1, m + 1)."""
        pairs = self.values[:-1, :-1, :-2]
        return np.ascontiguousarray(pairs).view(np.complex128)

    def energies(self) -> Array:
        """Σ |d|² over both signs of k, for every degree and harmonic."""
        out = np.empty((self.degree + 1, self.harmonics + 1))
        shell_energies(self.values, self.limits, out)
        return out

    def within(self, limits: Limits) -> Expansion:
        """The same coefficients under other limits, zero where they were not held."""
        target = Expansion.empty(limits)
        n = min(self.degree, target.degree) + 2
        m = min(self.values.shape[2], target.values.shape[2]) - 2
        target.values[:n, :n, :m] = self.values[:n, :n, :m]
        target.clear_outside()
        return target

    @classmethod
    def unpacked(cls, limits: Limits, packed: Array) -> Expansion:
        """The expansion whose `packed` values these are."""
        made = cls.empty(limits)
        made.values[~made._outside()] = packed
        return made

    @staticmethod
    def size(limits: Limits) -> int:
        """Length of `packed` within these limits."""
        return int(np.sum((np.arange(limits.size) + 1) * 2 * (limits + 1)))

    def packed(self) -> Array:
        """Values within the limits, in the order of the array."""
        return np.asarray(self.values[~self._outside()])

    def clear_outside(self) -> None:
        """Set to zero what lies outside the limits."""
        self.values[self._outside()] = 0.0

    def _outside(self) -> NDArray[np.bool_]:
        n, width = self.values.shape[0], self.values.shape[2]
        padded = np.full(2 * n, -1)
        padded[: self.limits.size] = self.limits
        allowed = padded[np.add.outer(np.arange(n), np.arange(n))]
        harmonic = np.arange(width) // 2
        return np.asarray(harmonic[None, None, :] > allowed[:, :, None])


def significant(energies: Array, threshold: float) -> NDArray[np.bool_]:
    """Cells (degree, harmonic) that together hold all but `threshold` of the norm."""
    return energies > threshold**2 / energies.size


def spread(
    energies: Array, threshold: float, margin: float, cap: tuple[int, int]
) -> Limits:
    """Limits around the significant cells, and some room beyond them.

    The room is `margin` times the last significant harmonic, and `ROOM` degrees times
    `margin`. In these limits the last harmonic never rises with the degree.
    """
    degree, harmonics = cap
    found = significant(energies, threshold)
    width = found.shape[1]
    last = np.where(found.any(axis=1), width - 1 - found[:, ::-1].argmax(axis=1), -1)
    # A coefficient may vanish by symmetry between others that count.
    last = np.maximum.accumulate(last[::-1])[::-1]
    reach = math.ceil(ROOM * margin)
    room = math.ceil(margin * max(3, int(last.max(initial=0))))
    widened = np.full(last.size + reach, -1)
    for shift in range(reach + 1):
        # A quarter of an ellipse of room: none at the farthest degree.
        extra = round(room * math.sqrt(1.0 - (shift / (reach + 1)) ** 2))
        part = widened[shift : shift + last.size]
        np.maximum(part, np.where(last >= 0, last + extra, -1), out=part)
    return np.asarray(np.minimum(widened[: degree + 1], harmonics), np.int64)
