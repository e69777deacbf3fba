"""The backward generator of a smooth fibre about where it lies."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from fpsolve._support.arrays import Array
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.spectral.bases.placement import Placement, belt_speed, throwing_ranges
from fpsolve.spectral.resolvent.smooth_basis import SmoothBasis

__all__ = ["SmoothGenerator", "hermite_of_wave"]


@dataclass(frozen=True, eq=False)
class SmoothGenerator:
    """L = (τ + v e1)·∇ + κ ∂_α − (κ + ∇B·τ⊥)/R ∂_κ + (K²/2) ∂_κκ in a basis.

    Densities are expanded in w^ϑ He, observables in w^{1−ϑ} He with a Gaussian w of x1
    = (ξ1 − c)/S1, x2 = ξ2/S2 and κ/g, since the law of a smooth fibre has wider tails
    than Gaussians. There x = a + a†, ∂_x = ϑ a − (1−ϑ) a† with a he_m = √m he_{m−1}.
    The constants are no function of the basis, and L loses a little of them in
    every truncation.

    Attributes
    ----------
    model : SmoothLayDownModel
    placement : Placement
        c, S1, S2, g and the exponents ϑ.
    basis : SmoothBasis
    parameters : tuple of str
        What it can be differentiated in.
    """

    parameters: ClassVar[tuple[str, ...]] = (
        "noise", "belt_speed", "sigma1", "sigma2", "relaxation_length",
    )  # fmt: skip

    model: SmoothLayDownModel
    placement: Placement
    basis: SmoothBasis

    @property
    def scales(self) -> tuple[float, float]:
        """The throwing ranges."""
        return throwing_ranges(self.model)

    @property
    def speed(self) -> float:
        """v of the belt."""
        return belt_speed(self.model)

    @cached_property
    def directions(self) -> tuple[sparse.csr_array, sparse.csr_array]:
        """Multiplication by cos α and by sin α."""
        cosine, sine, _ = self.basis.flat.turned()
        same = _identity(self.basis.flat.planes[0].size)
        on_curvature = _identity(self.basis.curvature + 1)
        cosines, sines = (
            self.basis.product(same, one, on_curvature) for one in (cosine, sine)
        )
        return cosines, sines

    @cached_property
    def matrix(self) -> sparse.csr_array:
        """L; column and row are the states of the basis."""
        cosine, sine, turn = self.basis.flat.turned()
        slopes, forces = self._planes()
        kappa, slope, scaling, spreading = self._curvature()
        relaxing = (
            0.5 * self.model.curvature_noise**2 * spreading
            - scaling / self.model.relaxation_length
        )
        on_planes, on_circle, on_curvature = (
            _identity(one.shape[0]) for one in (slopes[0], turn, slope)
        )
        parts = (
            (slopes[0], cosine + self.speed * on_circle, on_curvature),
            (slopes[1], sine, on_curvature),
            (on_planes, turn, kappa),
            (forces[0], sine, slope),
            (-forces[1], cosine, slope),
            (on_planes, on_circle, relaxing),
        )
        return sum(self.basis.product(*part) for part in parts)

    def _planes(self) -> tuple[list[sparse.csr_array], list[sparse.csr_array]]:
        """∂_i, and multiplication by ξ_i/(σ_i² R), between the planes."""
        exponent, centre = self.placement.exponent, self.placement.centre
        slopes, forces = [], []
        for axis, (width, sigma) in enumerate(
            zip(self.placement.widths, self.scales, strict=True)
        ):
            lower = self.basis.flat.lowering(axis)
            slopes.append((exponent * lower - (1.0 - exponent) * lower.T) / width)
            offset = (centre, 0.0)[axis] * _identity(lower.shape[0])
            stiffness = 1.0 / (sigma**2 * self.model.relaxation_length)
            forces.append(stiffness * (width * (lower + lower.T) + offset))
        return slopes, forces

    @cached_property
    def curvatures(self) -> sparse.csr_array:
        """κ, between its polynomials."""
        return self._curvature()[0]

    def _curvature(self) -> tuple[sparse.csr_array, ...]:
        """κ, ∂_κ, κ ∂_κ and ∂_κκ.

        Products are formed with two degrees more, so that no neighbour is lost.
        """
        weight, last = self.placement.curvature, self.basis.curvature
        root = math.sqrt(weight.variance)
        lower = sparse.diags_array(np.sqrt(np.arange(1.0, last + 3)), offsets=1).tocsr()
        kappa = root * (lower + lower.T)
        slope = (weight.exponent * lower - (1.0 - weight.exponent) * lower.T) / root
        parts = kappa, slope, kappa @ slope, slope @ slope
        return tuple(one.tocsr()[: last + 1, : last + 1] for one in parts)

    @cached_property
    def one(self) -> Array:
        """Coefficients of 1."""
        return self.function(*(self.constant(axis) for axis in range(3)))

    def constant(self, axis: int) -> Array:
        """Coefficients of 1 in x1, x2 (`axis` 0, 1) or κ (2)."""
        if axis == 2:
            exponent, degree = self.placement.curvature.exponent, self.basis.curvature
        else:
            exponent, degree = self.placement.exponent, self.basis.degree
        return hermite_of_wave(0.0, degree, exponent).real

    def function(self, along: Array, across: Array, curvature: Array) -> Array:
        """Coefficients of a product of functions of x1, of x2 and of κ."""
        basis = self.basis
        values = np.zeros(basis.size, np.result_type(along, across))
        plain = basis.without_angle
        m, n, _, j = (one[plain] for one in basis.states)
        values[plain] = along[m] * across[n] * curvature[j]
        return values

    @cached_property
    def stationary(self) -> Array:
        """p with p L = 0 and p·1 = 1, even under (ξ2, α, κ) → −(ξ2, α, κ).

        One equation follows from the others, but for what a truncation loses; that of
        the first state is left out.
        """
        even = self.basis.parity(1)
        inner = even[1:]
        source = self.matrix[[even[0]]][:, inner].toarray()[0]
        p = np.zeros(self.basis.size)
        p[even[0]] = 1.0
        p[inner] = self._inner_factors().solve(-source, trans="T")
        return p / (p @ self.one)

    def _inner_factors(self) -> Any:
        """Of L between the even states but the first one."""
        inner = self.basis.parity(1)[1:]
        return splu(self.matrix[inner][:, inner].tocsc())

    @cached_property
    def derivatives(self) -> tuple[sparse.csr_array, ...]:
        """∂L in every parameter, of the same functions of ξ, α and κ.

        The Gaussians are kept where they stand, whatever rule put them there. A and R
        are the ones to be kept constant, so that K = A/R changes with both.
        """
        cosine, sine, turn = self.basis.flat.turned()
        slopes, (force1, force2) = self._planes()
        _, slope, scaling, spreading = self._curvature()
        noise, length = self.model.noise, self.model.relaxation_length
        on_planes, on_circle, on_curvature = (
            _identity(one.shape[0]) for one in (slopes[0], turn, slope)
        )
        sigma1, sigma2 = self.scales
        product = self.basis.product
        by1, by2 = product(force1, sine, slope), product(-force2, cosine, slope)
        relaxing = scaling / length**2 - noise**2 / length**3 * spreading
        return (
            product(on_planes, on_circle, noise / length**2 * spreading),
            product(slopes[0], on_circle, on_curvature),
            -2.0 / sigma1 * by1,
            -2.0 / sigma2 * by2,
            product(on_planes, on_circle, relaxing) - (by1 + by2) / length,
        )

    @cached_property
    def stationary_derivatives(self) -> Array:
        """∂p in every parameter, (parameter, state): ∂p L = −p ∂L and ∂p·1 = 0."""
        inner, factors = self.basis.parity(1)[1:], self._inner_factors()
        found = np.zeros((len(self.parameters), self.basis.size))
        for row, change in zip(found, self.derivatives, strict=True):
            row[inner] = factors.solve(-(change.T @ self.stationary)[inner], trans="T")
        return found - np.multiply.outer(found @ self.one, self.stationary)


def hermite_of_wave(q: float, degree: int, exponent: float) -> Array:
    """c_m = ∫ e^{iqx − ϑx²/2} he_m(x) dx/√(2π), m = 0 … degree.

    c_0 = e^{−q²/2ϑ}/√ϑ and √(m+1) c_{m+1} = (iq/ϑ) c_m + (1/ϑ − 1) √m c_{m−1}.
    """
    found = np.zeros(degree + 1, complex)
    found[0] = math.exp(-0.5 * q * q / exponent) / math.sqrt(exponent)
    for m in range(degree):
        before = math.sqrt(m) * found[m - 1] if m else 0.0
        following = 1j * q / exponent * found[m] + (1.0 / exponent - 1.0) * before
        found[m + 1] = following / math.sqrt(m + 1)
    return found


def _identity(n: int) -> sparse.csr_array:
    return sparse.eye_array(n, format="csr")
