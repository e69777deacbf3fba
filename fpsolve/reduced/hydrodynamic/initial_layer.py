"""The initial layer: how the angle is forgotten, and what it leaves behind."""

from __future__ import annotations

import math

import numpy as np

from fpsolve._support.arrays import Array, check_finite_numbers
from fpsolve._support.checks import check_non_negative, check_positive
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.plane import PlaneGrid
from fpsolve.model.persistence import Persistence

__all__ = ["InitialLayer"]


class InitialLayer:
    """p ≈ slow + Σ_{n≠0} c_n(ξ) e^{inα} e^{−n²A²s/2} + (ε/π) ∇·J e^{−A²s/2}.

    On the fast scale A²s the angle diffuses at frozen ξ: the harmonics c_n of the
    start die as e^{−n²A²s/2} and its plane density 𝒫₀ = ∫ p0 dα stays. Meanwhile the
    first harmonic, J = ∫ τ p0 dα, moves mass: ∂ₛ𝒫 = −∇·(J e^{−A²s/2}) adds up to
    −2ε∇·J, ε = 1/A². The slow equation therefore starts from 𝒫₀ − 2ε∇·J, a
    displacement by 2ε E τ, and the layer holds back what has not arrived yet, the last
    term above. For B = 0 without a belt this is the exact mean
    E(ξ_s − ξ_0) = 2ε(1 − e^{−A²s/2}) E τ.

    Of a smooth fibre, whose curvature at the start is the stationary Gaussian of a free
    one, independent of ξ and α, p is the density of (ξ, α). With
    ψ(s) = (A²/2)(s − R(1 − e^{−s/R})) in place of A²s/2 the same holds, but that
    2ε is 2εF and the last term (1/2π) ∇·J ∫_s^∞ e^{−ψ(u)} du; see `Persistence`.

    Exact: mass; the composite approximation has the given start up to ε p₁. Its
    plane density is accurate to O(ε²) and p itself to O(ε) within the layer, while s
    is not large against 1/ε. Can fail: the corrected start is negative where
    2ε∇·J > 𝒫₀, in the tail behind a directed start.

    Parameters
    ----------
    p0 : ndarray, shape (n1, n2, n_alpha)
        Initial density.
    grid : PhaseSpaceGrid
    noise : float
        A > 0.
    relaxation_length : float, optional
        R of a smooth fibre.

    Attributes
    ----------
    plane : PlaneGrid
    density_at_start : ndarray, shape (n1, n2)
        𝒫₀ = ∫ p0 dα.
    corrected_start : ndarray, shape (n1, n2)
        𝒫₀ − 2εF∇·J: where the slow equation starts.

    References
    ----------
    [KMW09]_, below equation (18); [BGKMW08]_.
    """

    def __init__(
        self,
        p0: Array,
        grid: PhaseSpaceGrid,
        noise: float,
        relaxation_length: float = 0.0,
    ) -> None:
        self.plane = PlaneGrid.of(grid)
        self.p0, self.grid = checked_start(p0, grid), grid
        self.noise = check_positive("noise", noise)
        self.density_at_start = self.p0.sum(axis=2) * grid.spacing[2]
        length = check_non_negative("relaxation_length", relaxation_length)
        self.persistence = Persistence(self.noise, length)
        self.displaced = self.persistence.length * self._divergence()

    @property
    def corrected_start(self) -> Array:
        """𝒫₀ − 2εF∇·J, shape (n1, n2)."""
        return np.asarray(self.density_at_start - self.displaced)

    @property
    def length(self) -> float:
        """2F/A²: the arclength over which the first harmonic falls by e for R = 0."""
        return self.persistence.length

    def density(self, s: float) -> Array:
        """The layer at s >= 0, to be added to the slow part; ``grid.shape``."""
        s = check_non_negative("s", s)
        waves = np.fft.rfft(self.p0, axis=2)
        # The slow part has the mean over the angle; in the layer only the mass that
        # is still on its way is left of it.
        degrees = np.arange(self.grid.shape[2] // 2 + 1)
        waves *= np.exp(-self.persistence.turned(s) * degrees**2)
        on_its_way = self.persistence.beyond(s) / self.persistence.length
        share = self.grid.shape[2] / (2 * math.pi) * on_its_way
        waves[:, :, 0] = share * self.displaced
        return np.fft.irfft(waves, n=self.grid.shape[2], axis=2)

    def _divergence(self) -> Array:
        """∇·∫ τ p0 dα, from fluxes through the faces; none through the walls."""
        total = np.zeros(self.plane.shape)
        for axis, direction in enumerate((np.cos, np.sin)):
            flux = (self.p0 @ direction(self.grid.alpha)) * self.grid.spacing[2]
            flux = np.moveaxis(flux, axis, 0)
            through = np.zeros((len(flux) + 1, flux.shape[1]))
            through[1:-1] = 0.5 * (flux[1:] + flux[:-1])
            change = np.diff(through, axis=0) / self.grid.spacing[axis]
            total += np.moveaxis(change, 0, axis)
        return total


def checked_start(p0: Array, grid: PhaseSpaceGrid) -> Array:
    """The density at the start, on the grid, finite and with mass."""
    density = check_finite_numbers("p0", grid.check(p0, "p0"))
    if not density.sum() > 0:
        raise ValueError(f"`p0` must have positive mass, got {density.sum():g}.")
    return density
