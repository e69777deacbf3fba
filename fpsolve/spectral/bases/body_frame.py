"""A smooth fibre about an isotropic quadratic B, seen from its own frame."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csc_array, diags_array, eye_array, kron

from fpsolve._support.arrays import Complex
from fpsolve.grids.smooth import SmoothPhaseSpaceGrid
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.spectral.bases.body_frame_moments import body_frame_moments
from fpsolve.spectral.bases.body_frame_values import values_on
from fpsolve.spectral.bases.body_states import BodyStates
from fpsolve.spectral.bases.curvature import curvature_degree, curvature_operators
from fpsolve.spectral.bases.isotropic import index_of, isotropic_sectors
from fpsolve.spectral.bases.sectors import Integers, Sector, Truncation, Vector
from fpsolve.spectral.bases.smooth import SmoothDiscretisation
from fpsolve.spectral.bases.weights import (
    Weight,
    curvature_weight,
    position_weight,
    quadratic,
)

__all__ = ["BodyFrameDiscretisation"]


@dataclass(frozen=True)
class BodyFrameDiscretisation(SmoothDiscretisation):
    """L in e^{iMα} times functions of X = ξ·τ, Y = ξ·τ⊥ and κ.

    For B = ‖ξ‖²/(2σ²) on a fixed belt (22) reads dX = (1 + κY) ds, dY = -κX ds in the
    frame of the fibre, so that with θ the polar angle of (X, Y) in it

        L = ∂_X + κ(iM - ∂_θ) - (κ + Y/σ²)/R ∂_κ + (K²/2) ∂_κκ

    on functions of total angular index M. With w = (X + iY)/(√2 S), a = ∂_w and
    b = ∂_w̄, the multiplications by w and w̄ are a† + b and b† + a; a state (n_a, n_b, j)
    of angular index l = n_a - n_b in the frame, degree n_a + n_b <= `degree` and degree
    j <= `curvature` is taken to others by

        [ϑ(a + b) - (1 - ϑ)(a† + b†)]/(√2 S) + (M - l) iκ
            + S/(√2 σ²R) (a† + b - b† - a) i∂_κ - (κ/R) ∂_κ + (K²/2) ∂_κκ,

    κ and ∂_κ those of `CurvatureOperators`. Observables, and so eigenfunctions of L,
    are polynomials times w^{1-ϑ}; densities are polynomials times w^ϑ with the
    transposed matrix. For M = 0 the reflection (Y, κ) → -(Y, κ) exchanges n_a and n_b
    and multiplies by (-1)^j.

    Norms and residuals are those of coefficients: in L² with the weight w^{2ϑ-1}, of
    the position and of the curvature.

    Parameters
    ----------
    model : SmoothLayDownModel
        With noise, an isotropic quadratic potential, on a fixed belt.
    """

    model: SmoothLayDownModel

    @property
    def noise(self) -> float:  # type: ignore[override]
        """Noise amplitude A = RK."""
        return self.model.noise

    @cached_property
    def position(self) -> Weight:
        """Weight in ξ."""
        return position_weight(self.model)

    @cached_property
    def curvature(self) -> Weight:
        """Weight in κ."""
        return curvature_weight(self.model)

    def sectors(self) -> Iterator[Sector]:
        """M = 0 even, M = 0 odd, ±1, ±2, ..."""
        return isotropic_sectors()

    def truncation(self, level: int) -> Truncation:
        """Degree 12, 16, 20, 24, 30, ... (a factor 2^⅓ each), and what it needs in κ.

        All even: odd ones converge to the same, but alternate with them.
        """
        degree = 2 * round(6 * 2 ** (level / 3))
        return Truncation(degree, degree, curvature_degree(self.model, degree))

    def enlarged(self, truncation: Truncation) -> Truncation:
        """One degree more in ξ and two in κ: L f lies there exactly."""
        degree = truncation.degree + 1
        return Truncation(degree, degree, truncation.curvature + 2)

    def size(self, sector: Sector, truncation: Truncation) -> int:
        """Number of basis functions: half of all those of M = 0 of each parity."""
        degree, j = truncation.degree, truncation.curvature
        whole = (degree + 1) * (degree + 2) // 2 * (j + 1)
        if sector.parity is None:
            return whole
        # Those with n_a = n_b have one j in two, beginning with 0 or 1.
        own = (j + 1 + (sector.parity == 1)) // 2
        single = degree // 2 + 1
        return (whole - single * (j + 1)) // 2 + single * own

    def factor_entries(self, truncation: Truncation) -> int:
        """Entries of the factors of ±M, by blocks of one l: l is taken to l ± 1 only.

        Measured: the elimination of columns in the order COLAMD leaves as many, within
        a third, from 5000 functions on.
        """
        blocks = (truncation.degree - np.arange(truncation.degree + 1)) // 2 + 1.0
        return int(4 * (truncation.curvature + 1) ** 2 * np.sum(blocks**2))

    def states(self, sector: Sector, truncation: Truncation) -> BodyStates:
        """The basis functions of a sector."""
        return BodyStates(sector, truncation)

    def harmonics(self, sector: Sector, truncation: Truncation) -> Integers:
        """The harmonic k = M - l of every basis function."""
        states = self.states(sector, truncation)
        harmonics: Integers = index_of(sector) - states.angular
        return harmonics

    def matrix(self, sector: Sector, *sizes: int) -> csc_array:
        """The real matrix of L on a sector (columns: images)."""
        states = self.states(sector, Truncation(*sizes))
        folding = states.folding
        return csc_array(folding.T @ self._unfolded(states, index_of(sector)) @ folding)

    def noise_derivative(self, sector: Sector, truncation: Truncation) -> csc_array:
        """dL/dA = (A/R²) ∂_κκ, from L(√2 A) - L(A) = (K²/2) ∂_κκ on fixed functions."""
        states, model = self.states(sector, truncation), self.model
        loud = math.sqrt(2.0) * model.noise
        louder = SmoothLayDownModel(model.potential, model.relaxation_length, loud)
        here, there = (
            curvature_operators(one, self.curvature, states.curvature).relaxing
            for one in (model, louder)
        )
        same_place = eye_array(states.n_plane)
        change = kron(same_place, (there - here) * (2.0 / self.noise))
        return csc_array(states.folding.T @ csc_array(change) @ states.folding)

    def _unfolded(self, states: BodyStates, index: int) -> csc_array:
        """L on all states of a total angular index, for M = 0 of both parities."""
        kappa = curvature_operators(self.model, self.curvature, states.curvature)
        width, exponent = math.sqrt(self.position.variance), self.position.exponent
        down_a, down_b = states.lowering()
        up_a, up_b = down_a.T, down_b.T
        motion = exponent * (down_a + down_b) - (1.0 - exponent) * (up_a + up_b)
        turn = diags_array(index - states.plane_angular.astype(float))
        stiffness = quadratic(self.model).sigma1 ** 2 * self.model.relaxation_length
        # Y/(σ²R), but for the factor -i that belongs to ∂_κ.
        force = (up_a + down_b - up_b - down_a) * (width / stiffness)
        root = math.sqrt(0.5)
        same_kappa = eye_array(states.curvature + 1)
        same_place = eye_array(states.n_plane)
        return csc_array(
            kron(motion * (root / width), same_kappa)
            + kron(turn, kappa.turning)
            + kron(force * root, kappa.forced)
            + kron(same_place, kappa.relaxing)
        )

    def embed(
        self, vector: Vector, sector: Sector, small: Truncation, large: Truncation
    ) -> Vector:
        """Coefficients in the larger basis."""
        inner, outer = self.states(sector, small), self.states(sector, large)
        result = np.zeros(len(outer.m), dtype=vector.dtype)
        result[outer.numbers(inner.m, inner.n, inner.j)] = vector
        return result

    def values(
        self,
        vector: Vector,
        sector: Sector,
        truncation: Truncation,
        grid: SmoothPhaseSpaceGrid,
    ) -> Complex:
        """f(ξ, α, κ) on the grid, shape ``grid.shape``, from its coefficients.

        Of the odd sector M = 0 times -i, so that real coefficients make it real.
        """
        table = self._table(vector, sector, truncation)
        position = Weight(self.position.variance, 1.0 - self.position.exponent)
        curvature = Weight(self.curvature.variance, 1.0 - self.curvature.exponent)
        return values_on(table, index_of(sector), position, curvature, grid)

    def dual_values(
        self,
        vector: Vector,
        sector: Sector,
        truncation: Truncation,
        grid: SmoothPhaseSpaceGrid,
    ) -> Complex:
        """The density of a vector of the transposed matrix: of -M, on the grid.

        Its pairing ∫ p f with f of `values` is that of the coefficients.
        """
        table = self._table(vector.conj(), sector, truncation)
        # ∫ w of both weights and of the angle.
        plane = 2 * math.pi * self.position.variance
        scale = 2 * math.pi * plane * math.sqrt(2 * math.pi * self.curvature.variance)
        p = values_on(table, index_of(sector), self.position, self.curvature, grid)
        return p.conj() / scale

    def stationary_moments(
        self, vector: Vector, truncation: Truncation
    ) -> dict[str, float]:
        """`mass` and SMOOTH_MOMENTS over the mass, of the stationary sector."""
        table = self._table(vector, self.stationary_sector, truncation).real
        return body_frame_moments(table, self.position, self.curvature)

    def _table(self, vector: Vector, sector: Sector, truncation: Truncation) -> Vector:
        """Coefficients [n_a, n_b, j] of all states, both of a folded pair."""
        return self.states(sector, truncation).table(vector)
