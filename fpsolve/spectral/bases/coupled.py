"""A smooth fibre about any quadratic B, on any belt: coupled angular indices."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from scipy.sparse import block_array, csc_array, diags_array, eye_array, kron

from fpsolve._support.arrays import Complex
from fpsolve.grids.smooth import SmoothPhaseSpaceGrid
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.spectral.bases.coupled_blocks import Blocks, coupled, rows
from fpsolve.spectral.bases.coupled_moments import coupled_moments, coupled_one
from fpsolve.spectral.bases.coupled_states import CoupledStates
from fpsolve.spectral.bases.coupled_values import coupled_values
from fpsolve.spectral.bases.curvature import curvature_operators
from fpsolve.spectral.bases.placement import Placement, belt_speed, throwing_ranges
from fpsolve.spectral.bases.sectors import (
    Integers,
    Sector,
    Truncation,
    Vector,
)
from fpsolve.spectral.bases.smooth import SmoothDiscretisation
from fpsolve.spectral.bases.weights import Weight

__all__ = ["CoupledDiscretisation"]


@dataclass(frozen=True)
class CoupledDiscretisation(SmoothDiscretisation):
    """L in e^{iMα} times functions of the frame of the fibre and κ, |M| <= harmonics.

    With x1 = (ξ1 - c)/S1, x2 = ξ2/S2 and w = (x1 + i x2) e^{-iα}/√2 the generator of
    (22) for B = ξ1²/(2σ1²) + ξ2²/(2σ2²) and the belt speed v is

        L = s₊(∂_w + ∂_w̄) + s₋(e^{-2iα} ∂_w + e^{2iα} ∂_w̄)
            + v/(√2 S1) (e^{-iα} ∂_w + e^{iα} ∂_w̄) + κ ∂_α - (κ + F)/R ∂_κ
            + (K²/2) ∂_κκ,
        iF = f₊(w - w̄) - f₋(e^{2iα} w - e^{-2iα} w̄) - c/(2σ1²) (e^{iα} - e^{-iα}),

    with s± = (1/S1 ± 1/S2)/√8 and f± = (S1/σ1² ± S2/σ2²)/√8. What has no e^{iα} leaves
    M as it is and is that of `BodyFrameDiscretisation`; the rest couples M to M ± 1 and
    M ± 2, and vanishes for σ1 = σ2 and v = 0. In the basis of a `Placement`
    ∂_w = ϑ a - (1-ϑ) b† and w = a† + b on observables; on densities the transposed
    matrix acts.

    The reflection (ξ2, α, κ) → -(ξ2, α, κ) takes M to -M. On a fixed belt turning by π
    separates even M from odd ones.

    Parameters
    ----------
    model : SmoothLayDownModel
        With noise, a quadratic potential, on a belt at rest or at constant speed.
    placement : Placement
        The weights of the basis.
    """

    model: SmoothLayDownModel
    placement: Placement
    irregular: ClassVar[bool] = True

    @property
    def noise(self) -> float:  # type: ignore[override]
        """Noise amplitude A = RK."""
        return self.model.noise

    @property
    def belt_speed(self) -> float:  # type: ignore[override]
        """Belt speed v."""
        return belt_speed(self.model)

    def sectors(self) -> Iterator[Sector]:
        """The two parities, or four pairs of them on a fixed belt."""
        for parity in (1, -1):
            if self.belt_speed:
                yield Sector(parity=parity)
            else:
                yield Sector(parity=parity, parity_along=1)
                yield Sector(parity=parity, parity_along=-1)

    def truncation(self, level: int) -> Truncation:
        """Degree 6, 8, 10, 13, 17, 22, ... and what it deserves."""
        degree = 6 + 2 * level if level < 2 else round(10 * 1.3 ** (level - 2))
        return self.truncation_of(degree)

    def truncation_of(self, degree: int) -> Truncation:
        """|M| and the degree in κ that a degree in ξ deserves.

        Each is responsible for about as much of the error of moments, so that a change
        from one truncation to the next shows all three. Measured, with a = A²R/2.
        """
        a = 0.5 * self.model.noise**2 * self.model.relaxation_length
        share = 0.8 + (a + 4.0 * math.sqrt(a)) / 35.0
        return Truncation(degree, 4 + degree // 2, math.ceil(share * degree))

    def stationary_moments(
        self, vector: Vector, truncation: Truncation
    ) -> dict[str, float]:
        """`mass` and SMOOTH_MOMENTS over the mass, of the stationary sector."""
        states = self.states(self.stationary_sector, truncation)
        return coupled_moments(states, vector, self.placement)

    def constants(self, sector: Sector, truncation: Truncation) -> Vector:
        """Coefficients of 1 of the stationary sector."""
        return coupled_one(self.states(sector, truncation), self.placement)

    def enlarged(self, truncation: Truncation) -> Truncation:
        """One degree more in ξ, two indices and two degrees in κ: L f lies there."""
        degree, harmonics, curvature = truncation
        return Truncation(degree + 1, harmonics + 2, curvature + 2)

    def states(self, sector: Sector, truncation: Truncation) -> CoupledStates:
        """The basis functions of a sector."""
        return CoupledStates(sector, truncation)

    def harmonics(self, sector: Sector, truncation: Truncation) -> Integers:
        """The harmonic k = M - l of every basis function."""
        return self.states(sector, truncation).harmonics

    def size(self, sector: Sector, truncation: Truncation) -> int:
        """Number of basis functions."""
        return self.states(sector, truncation).size

    def matrix(self, sector: Sector, *sizes: int) -> csc_array:
        """The real matrix of L on a sector (columns: images)."""
        states = self.states(sector, Truncation(*sizes))
        blocks = self.blocks(states)
        return csc_array(block_array(rows(states, blocks), format="csc"))

    def blocks(self, states: CoupledStates) -> Blocks:
        """L between angular indices, on plain states."""
        plain = states.plain
        kappa = curvature_operators(
            self.model, self.placement.curvature, plain.curvature
        )
        same = eye_array(plain.curvature + 1)
        angular = diags_array(plain.plane_angular.astype(float))
        moving, forcing = self._planes(plain.lowering())
        own = (
            kron(moving.pop(0), same)
            + kron(forcing.pop(0), kappa.forced)
            - kron(angular, kappa.turning)
            + kron(eye_array(plain.n_plane), kappa.relaxing)
        )
        turning = kron(eye_array(plain.n_plane), kappa.turning)
        couplings = coupled(moving, forcing, kappa)
        return Blocks(csc_array(own), csc_array(turning), couplings)

    def _planes(
        self, lowering: tuple[csc_array, csc_array]
    ) -> tuple[dict[int, Any], dict[int, Any]]:
        """What goes with 1 and with i∂_κ from M to M + the key, on the plane."""
        lower_a, lower_b = lowering
        theta = self.placement.exponent
        slope = theta * lower_a - (1.0 - theta) * lower_b.T
        slope_bar = theta * lower_b - (1.0 - theta) * lower_a.T
        wave, wave_bar = lower_a.T + lower_b, lower_b.T + lower_a
        sigma1, sigma2 = throwing_ranges(self.model)
        width1, width2 = self.placement.widths
        length, root = self.model.relaxation_length, math.sqrt(0.5)
        along, across = root / width1, root / width2
        force1 = root * width1 / (sigma1**2 * length)
        force2 = root * width2 / (sigma2**2 * length)
        motion, motion2 = 0.5 * (along + across), 0.5 * (along - across)
        force, force_2 = 0.5 * (force1 + force2), 0.5 * (force1 - force2)
        belt = self.belt_speed * along
        pull = 0.5 * self.placement.centre / (sigma1**2 * length)
        same = eye_array(lower_a.shape[0])
        moving = {
            0: motion * (slope + slope_bar),
            1: belt * slope_bar,
            -1: belt * slope,
            2: motion2 * slope_bar,
            -2: motion2 * slope,
        }
        forcing = {
            0: force * (wave - wave_bar),
            1: -pull * same,
            -1: pull * same,
            2: -force_2 * wave,
            -2: force_2 * wave_bar,
        }
        return moving, forcing

    def embed(
        self, vector: Vector, sector: Sector, small: Truncation, large: Truncation
    ) -> Vector:
        """Coefficients in the larger basis."""
        inner, outer = self.states(sector, small), self.states(sector, large)
        result = np.zeros(outer.size, dtype=vector.dtype)
        places = {index: at for at, index in enumerate(outer.M)}
        for (index, part), source in zip(inner.slices(), inner.parts, strict=True):
            at = places[index]
            numbers = outer.parts[at].numbers(source.m, source.n, source.j)
            result[outer.offsets[at] + numbers] = vector[part]
        return result

    def values(
        self,
        vector: Vector,
        sector: Sector,
        truncation: Truncation,
        grid: SmoothPhaseSpaceGrid,
    ) -> Complex:
        """f(ξ, α, κ) on the grid, shape ``grid.shape``, from its coefficients."""
        states = self.states(sector, truncation)
        place, kappa = self.placement, self.placement.curvature
        weights = (
            Weight(1.0, 1.0 - place.exponent),
            Weight(kappa.variance, 1.0 - kappa.exponent),
        )
        return coupled_values(states, vector, place, weights, grid)

    def dual_values(
        self,
        vector: Vector,
        sector: Sector,
        truncation: Truncation,
        grid: SmoothPhaseSpaceGrid,
    ) -> Complex:
        """The density of a vector of the transposed matrix, on the grid.

        Its pairing ∫ p f with f of `values` is that of the coefficients.
        """
        states = self.states(sector, truncation)
        place, kappa = self.placement, self.placement.curvature
        weights = place.round, kappa
        p = coupled_values(states, vector.conj(), place, weights, grid)
        return p.conj() / self.dual_scale

    @cached_property
    def dual_scale(self) -> float:
        """∫ w of both weights and of the angle."""
        width1, width2 = self.placement.widths
        plane = 2 * math.pi * width1 * width2
        kappa = math.sqrt(2 * math.pi * self.placement.curvature.variance)
        return 2 * math.pi * plane * kappa
