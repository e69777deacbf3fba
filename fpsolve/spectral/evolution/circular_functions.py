"""Circular Hermite polynomials × Hermite polynomials of κ × e^{ikα}, under a weight."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array

__all__ = ["CircularFunctions", "Indices", "Scales", "Truncation"]

Indices = NDArray[np.int64]
# How far an operator moves an index: what it moves further is not kept anyway.
BORDER = 2
# The sectors |M| ≤ 2 hold the moments up to the second, and are kept whole.
OF_MOMENTS = 2


@dataclass(frozen=True)
class Truncation:
    """(p + q)/degree + n/curvature + (|M| − 2)₊/sectors ≤ 1.

    Attributes
    ----------
    degree : int
        Largest degree p + q in ξ.
    curvature : int
        Largest degree n in κ.
    sectors : int
        How far |M| goes beyond 2, at degree 0; none where sectors are not coupled.
    """

    degree: int
    curvature: int
    sectors: int

    @property
    def largest_sector(self) -> int:
        """Largest |M|."""
        return OF_MOMENTS + self.sectors

    @property
    def size(self) -> float:
        """About how many functions are kept: volumes of simplices."""
        plane = self.degree**2 * self.curvature
        return plane * ((2 * OF_MOMENTS + 1) / 6 + self.sectors / 12)

    def position(self, p: Indices, q: Indices, n: Indices, m: Indices) -> Array:
        """From 0, inside, to 1 on the last functions kept."""
        beyond = np.maximum(np.abs(m) - OF_MOMENTS, 0) / max(self.sectors, 1)
        return np.asarray((p + q) / self.degree + n / self.curvature + beyond)


@dataclass(frozen=True)
class Scales:
    """Variances of the weights, and the shares of them that the density carries.

    The density is expanded in (weight)^share times polynomials, and tested with
    (weight)^{1 − share} times polynomials.

    Attributes
    ----------
    plane, curvature : float
        Variances S² of the weight in ξ₁/σ₁ and in ξ₂/σ₂, and g² of that in κ.
    plane_share, curvature_share : float
        Between ½ and 1.
    """

    plane: float
    curvature: float
    plane_share: float
    curvature_share: float


@dataclass(frozen=True, eq=False)
class CircularFunctions:
    """ψ = iⁿ w^{1−ϑ} h_pq(ξ) v^{1−θ} He_n(κ/g) e^{ikα}, with k = M − p + q.

    h_pq are the polynomials in z = ξ₁/σ₁ + iξ₂/σ₂ and its conjugate that are
    orthonormal under the Gaussian w of variance S²; in ψ both weights are one at the
    origin. A turn of the plane by φ multiplies ψ by e^{iMφ}: for isotropic B on a belt
    at rest the sectors M are invariant. The reflection (ξ₂, α, κ) → −(ξ₂, α, κ) takes
    (p, q, n, M) to (−1)ⁿ (q, p, n, −M), and a real function has there the conjugate.

    Attributes
    ----------
    truncation : Truncation
    scales : Scales
    """

    truncation: Truncation
    scales: Scales

    @cached_property
    def indices(self) -> Indices:
        """p, q, n, M of every function; shape (4, size)."""
        t = self.truncation
        degrees = np.arange(t.degree + 1)
        sectors = np.arange(-t.largest_sector, t.largest_sector + 1)
        axes = degrees, degrees, np.arange(t.curvature + 1), sectors
        every = np.meshgrid(*axes, indexing="ij")
        kept = t.position(*every) <= 1.0 + 1e-12
        return np.stack([one[kept] for one in every])

    @property
    def size(self) -> int:
        """How many they are."""
        return int(self.indices.shape[1])

    @cached_property
    def harmonics(self) -> Indices:
        """k of every function."""
        p, q, _, m = self.indices
        return np.asarray(m - p + q)

    @cached_property
    def _places(self) -> NDArray[np.int32]:
        t = self.truncation
        last = t.degree, t.degree, t.curvature, 2 * t.largest_sector
        places = np.full([n + 1 + 2 * BORDER for n in last], -1, np.int32)
        p, q, n, m = self.indices + BORDER
        places[p, q, n, m + t.largest_sector] = np.arange(self.size)
        return places

    def moved(self, move: tuple[int, int, int, int]) -> Indices:
        """Places of the functions at (p, q, n, M) + move; −1 where none is kept."""
        p, q, n, m = (
            one + step + BORDER for one, step in zip(self.indices, move, strict=True)
        )
        found = self._places[p, q, n, m + self.truncation.largest_sector]
        return np.asarray(found, np.int64)

    @cached_property
    def reflected(self) -> Indices:
        """Places of the functions at (q, p, n, −M)."""
        p, q, n, m = self.indices
        last = self.truncation.largest_sector
        found = self._places[q + BORDER, p + BORDER, n + BORDER, last - m + BORDER]
        return np.asarray(found, np.int64)
