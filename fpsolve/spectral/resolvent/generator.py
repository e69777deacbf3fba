"""The backward generator in Hermite polynomials about where the fibre lies."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from fpsolve._support.arrays import Array
from fpsolve.model.laydown import LayDownModel
from fpsolve.spectral.evolution.quadratic import quadratic
from fpsolve.spectral.resolvent.basis import Basis

__all__ = ["Generator"]


@dataclass(frozen=True, eq=False)
class Generator:
    """L = (τ + v e1)·∇ − ∇B·τ⊥ ∂_α + D ∂_αα in a basis, D = A²/2.

    With x = (ξ − c)/σ, he_m = normalised Hermite polynomials and a he_m = √m he_{m−1},

        L = (cos α + v) a1/σ1 + sin α a2/σ2 + D ∂_αα
            + [sin α (a1 + a1† + c/σ1)/σ1 − cos α (a2 + a2†)/σ2] ∂_α.

    On a belt the stationary density is shifted by about A²v along it, where
    polynomials that are orthogonal about 0 would be of no use: the centre c is its
    mean, as well as it is known.

    Attributes
    ----------
    model : LayDownModel
    basis : Basis
    centre : float
        c, of ξ1; the mean of ξ2 is 0.
    parameters : tuple of str
        What it can be differentiated in.
    """

    parameters: ClassVar[tuple[str, ...]] = ("noise", "belt_speed", "sigma1", "sigma2")

    model: LayDownModel
    basis: Basis
    centre: float

    @property
    def scales(self) -> tuple[float, float]:
        """The throwing ranges."""
        potential = quadratic(self.model)
        return potential.sigma1, potential.sigma2

    @property
    def speed(self) -> float:
        """v of the belt."""
        return -float(self.model.curve.velocity(0.0)[0])

    @cached_property
    def directions(self) -> tuple[sparse.csr_array, sparse.csr_array]:
        """Multiplication by cos α and by sin α."""
        cosine, sine, _ = self.basis.turned()
        planes = self.basis.lowering(0)
        same = _identity(planes.shape[0])
        return self.basis.product(same, cosine), self.basis.product(same, sine)

    @property
    def positions(self) -> tuple[sparse.csr_array, sparse.csr_array]:
        """Multiplication by ξ1 − c and by ξ2, up to the last degree."""
        same = _identity(2 * self.basis.harmonics + 1)
        first, second = (
            self.basis.product(sigma * (lower + lower.T), same)
            for sigma, lower in zip(
                self.scales, map(self.basis.lowering, (0, 1)), strict=True
            )
        )
        return first, second

    @cached_property
    def matrix(self) -> sparse.csr_array:
        """L; column and row are the states of the basis."""
        basis, (sigma1, sigma2) = self.basis, self.scales
        cosine, sine, turn = basis.turned()
        lower1, lower2 = basis.lowering(0), basis.lowering(1)
        on_planes, on_circle = _identity(lower1.shape[0]), _identity(turn.shape[0])
        force1, force2 = self._forces
        parts = (
            (lower1 / sigma1, cosine + self.speed * on_circle),
            (lower2 / sigma2, sine),
            (force1, sine @ turn),
            (-force2, cosine @ turn),
            (self.model.diffusivity * on_planes, turn @ turn),
        )
        return sum(basis.product(*part) for part in parts)

    @property
    def _forces(self) -> tuple[sparse.csr_array, sparse.csr_array]:
        """Multiplication by ξ_i/σ_i², between the planes."""
        lower1, lower2 = self.basis.lowering(0), self.basis.lowering(1)
        sigma1, sigma2 = self.scales
        off = self.centre / sigma1 * _identity(lower1.shape[0])
        return (lower1 + lower1.T + off) / sigma1, (lower2 + lower2.T) / sigma2

    @cached_property
    def stationary(self) -> Array:
        """E of every state in the stationary law: g with g L = 0, its first one 1.

        It is even under (ξ2, α) → −(ξ2, α).
        """
        even = self.basis.parity(1)
        inner = self.matrix[even][:, even].tocsc()
        source = self.matrix[[0]][:, even].toarray()[0]
        g = np.zeros(self.basis.size)
        g[0] = 1.0
        g[even] = splu(inner).solve(-source, trans="T")
        return g

    @cached_property
    def derivatives(self) -> tuple[sparse.csr_array, ...]:
        """∂L in every parameter, of the same functions of ξ and α.

        Polynomials about the same c and of the same scale σ stay what they are when the
        parameters change, so that of σ_i only the force knows: of (ξ1/σ1²) sin α ∂_α it
        leaves −2 ξ1/σ1³ sin α ∂_α.
        """
        basis, (sigma1, sigma2) = self.basis, self.scales
        cosine, sine, turn = basis.turned()
        lower1, (force1, force2) = basis.lowering(0), self._forces
        on_planes, on_circle = _identity(lower1.shape[0]), _identity(turn.shape[0])
        parts = (
            (self.model.noise * on_planes, turn @ turn),
            (lower1 / sigma1, on_circle),
            (-2.0 / sigma1 * force1, sine @ turn),
            (2.0 / sigma2 * force2, cosine @ turn),
        )
        return tuple(basis.product(*part) for part in parts)

    @cached_property
    def stationary_derivatives(self) -> Array:
        """∂g in every parameter, (parameter, state): ∂g L = −g ∂L, its first one 0."""
        even = self.basis.parity(1)
        inner = splu(self.matrix[even][:, even].tocsc())
        found = np.zeros((len(self.parameters), self.basis.size))
        for row, change in zip(found, self.derivatives, strict=True):
            row[even] = inner.solve(-(change.T @ self.stationary)[even], trans="T")
        return found

    @property
    def mean(self) -> float:
        """E ξ1 in the stationary law."""
        m, n, harmonic = self.basis.states
        found = np.flatnonzero((m == 1) & (n == 0) & (harmonic == 0))[0]
        return float(self.centre + self.scales[0] * self.stationary[found])


def _identity(n: int) -> sparse.csr_array:
    return sparse.eye_array(n, format="csr")
