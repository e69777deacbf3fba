"""The backward generator of a round smooth potential in radial functions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

from fpsolve._support.arrays import Array
from fpsolve.spectral.bases.radial_basis import RadialBasis, radial_basis
from fpsolve.spectral.resolvent.basis import Integers
from fpsolve.spectral.resolvent.generator import Generator
from fpsolve.spectral.resolvent.round_basis import RoundBasis

__all__ = ["RoundGenerator", "throwing_range"]

# Relative size below which an entry is rounding of an exact zero.
ROUNDING = 1e-14
# Degrees beyond the truncation that its rule of integration has.
SPARE = 24
Between = Callable[[int], Array]


@dataclass(frozen=True, eq=False)
class RoundGenerator(Generator):
    """L = (τ + v e1)·∇ − ∇B·τ⊥ ∂_α + D ∂_αα for isotropic B, D = A²/2.

    The functions are orthonormal for e^{−B}, the stationary law at rest. Of a wave
    g(r) e^{i(lφ + kα)} L makes

        l − 1, k + 1 by ½ [g' + (l/r) g + k B' g], and back by minus the transpose,
        l ∓ 1, k     by ½ v [g' ± (l/r) g],
        l, k         by −D k²,

    so that at rest l + k is kept. A belt lays the fibre beside the nozzle, which
    the expansion of the stationary law in these functions has to resolve.

    Attributes
    ----------
    model : LayDownModel
        Its potential a smooth function of r².
    basis : RoundBasis
    centre : float
        0.
    """

    basis: RoundBasis

    @cached_property
    def radial(self) -> RadialBasis:
        """The radial functions."""
        return radial_basis(self.model.potential, self.basis.degree + SPARE)

    @property
    def scales(self) -> tuple[float, float]:
        """Root mean squares of ξ1 and of ξ2 at rest."""
        sigma = throwing_range(self.radial)
        return sigma, sigma

    @cached_property
    def directions(self) -> tuple[sparse.csr_array, sparse.csr_array]:
        """Multiplication by cos α and by sin α."""
        up, _ = self.basis.steps()
        same = sparse.eye_array(self.basis.planes[0].size, format="csr")
        return self._parts(self.basis.product(same, up))

    @cached_property
    def positions(self) -> tuple[sparse.csr_array, sparse.csr_array]:
        """Multiplication by ξ1 and by ξ2, up to the last degree."""
        same = sparse.eye_array(2 * self.basis.harmonics + 1, format="csr")
        down = self.basis.product(self._lowering(self._radius), same)
        return self._parts(sparse.csr_array(down.T))

    @cached_property
    def matrix(self) -> sparse.csr_array:
        """L; column and row are the states of the basis."""
        basis, degree = self.basis, self.basis.degree
        up, number = basis.steps()
        same = sparse.eye_array(number.shape[0], format="csr")
        planes = sparse.eye_array(basis.planes[0].size, format="csr")
        plain = self._lowering(lambda order: self.radial.raising(0, order, degree))
        force = self._lowering(
            lambda order: (
                self.radial.raising(1, order, degree)
                - self.radial.raising(0, order, degree)
            )
        )
        rising = basis.product(plain, up) + basis.product(force, up @ number)
        # g e^{ilφ} → l + 1 is the mirror image of l → l − 1.
        swap = self._exchange()
        drift = basis.product(plain + swap @ plain @ swap, same)
        noise = basis.product(planes, number @ number)
        waves = rising - rising.T + self.speed * drift
        return basis.folded(waves - self.model.diffusivity * noise)

    @property
    def mean(self) -> float:
        """E ξ1 in the stationary law."""
        return float(self.stationary @ self.positions[0][:, [0]].toarray()[:, 0])

    def _radius(self, angular: int) -> Array:
        """⟨g_{l−1}, r g_l⟩."""
        image, source = (
            self.radial.weighted(one, self.basis.degree)[0]
            for one in (angular - 1, angular)
        )
        return np.asarray((image * self.radial.rule.r) @ source.T)

    def _parts(
        self, waves: sparse.csr_array
    ) -> tuple[sparse.csr_array, sparse.csr_array]:
        """Re and Im of multiplication by e^{iα} or r e^{iφ}."""
        back = waves.T
        return (
            self.basis.folded(0.5 * (waves + back)),
            self.basis.folded(-0.5j * (waves - back)),
        )

    def _exchange(self) -> sparse.csr_array:
        """m ↔ n, between the planes."""
        m, n = self.basis.planes
        image = (m + n) * (m + n + 1) // 2 + m
        place = np.arange(m.size)
        return sparse.csr_array((np.ones(m.size), (image, place)))

    def _lowering(self, between: Between) -> sparse.csr_array:
        """Blocks from the radial functions of l to those of l − 1, all l."""
        degree, entries = self.basis.degree, []
        for angular in range(-degree + 1, degree + 1):
            block = between(angular)
            size = np.abs(block)
            found = np.nonzero(size > ROUNDING * np.max(size, initial=0.0))
            rows = _place(angular - 1, found[0])
            entries.append((rows, _place(angular, found[1]), block[found]))
        rows, columns, values = (
            np.concatenate([one[part] for one in entries]) for part in range(3)
        )
        n_planes = self.basis.planes[0].size
        return sparse.csr_array((values, (rows, columns)), shape=(n_planes, n_planes))


def _place(angular: int, j: Integers) -> Integers:
    """Of g_j^|l| e^{ilφ} among the planes."""
    degree = 2 * j + abs(angular)
    return degree * (degree + 1) // 2 + j + max(-angular, 0)


def throwing_range(radial: RadialBasis) -> float:
    """σ with 2σ² = E r² for the density e^{−B}/Z."""
    rule = radial.rule
    return float(np.sqrt(0.5 * np.exp(rule.log_weight) @ rule.r**2))
