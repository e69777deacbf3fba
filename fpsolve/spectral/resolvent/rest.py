"""Ŝ of a fibre on a belt at rest, sector by sector of the angular index."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import jv

from fpsolve._support.arrays import Array
from fpsolve.errors import ToleranceError
from fpsolve.model.laydown import LayDownModel
from fpsolve.spectral.bases.radial import RadialDiscretisation
from fpsolve.spectral.bases.radial_basis import radial_basis
from fpsolve.spectral.bases.sectors import Sector, Truncation
from fpsolve.spectral.resolvent.basis import Basis
from fpsolve.spectral.resolvent.ladder import (
    LOW_NOISE,
    MEMORY,
    ROUNDING,
    SAFETY,
    grown,
)
from fpsolve.spectral.resolvent.round_generator import throwing_range
from fpsolve.spectral.resolvent.waves import solver_of

__all__ = ["AtRest", "at_rest", "is_round_at_rest"]

# Sectors follow until one adds less than this share; they fall faster than any power.
NEGLIGIBLE = 1e-13
# The first truncation, and the largest: degree 354 and 60 harmonics.
FIRST, LAST_LEVEL = Basis(24, 10), 8
# Below this x the two terms of J0(x) − 1 = −x²/4 + x⁴/64 are exact to rounding.
SMALL = 1e-3


@dataclass(frozen=True)
class AtRest:
    """The sectors of one truncation.

    Attributes
    ----------
    model : LayDownModel
    basis : Basis
        Degree and harmonics.
    """

    model: LayDownModel
    basis: Basis

    def spectrum(self, k: Array) -> Array:
        """Ŝ(|k|) = 2 Σ_M ⟨J_M(|k| r), (−L_M)⁻¹ J_M(|k| r)⟩ in L²(r e^{−B} dr).

        e^{ik·ξ} = Σ i^M J_M(|k| r) e^{iM(φ − β)}, and L keeps M: one factorisation of a
        small matrix for each M serves all k. M and −M add the same.
        """
        total = np.zeros(k.size)
        for angular in range(self.basis.degree + 1):
            part = self.sector(angular, k)
            total += part
            if angular > 1 and (part <= NEGLIGIBLE * total).all():
                break
        return total

    def sector(self, angular: int, k: Array) -> Array:
        """What M and −M add."""
        degree, harmonics = self.basis.degree, self.basis.harmonics
        found = RadialDiscretisation(self.model.potential, self.model.noise)
        sector = Sector(0, 1) if angular == 0 else Sector(angular)
        matrix = found.matrix(sector, degree, harmonics)
        radial = radial_basis(self.model.potential, degree)
        functions, _ = radial.weighted(angular, degree)
        weight = np.exp(0.5 * radial.rule.log_weight)
        waves = functions @ (weight * bessel(angular, np.outer(k, radial.rule.r))).T
        plain = np.flatnonzero(
            found.harmonics(sector, Truncation(degree, harmonics)) == 0
        )
        right = np.zeros((matrix.shape[0], k.size))
        right[plain] = waves[: plain.size]
        if angular == 0:
            # Without the constant, of which L and J0 − E J0 have nothing.
            kept = np.delete(np.arange(matrix.shape[0]), plain[0])
            matrix, right = matrix[kept][:, kept], right[kept]
        solution = solver_of(-matrix).solve(right)
        times = 2 if angular == 0 else 4
        return np.asarray(times * np.einsum("ik,ik->k", right, solution))


def bessel(order: int, x: Array) -> Array:
    """J_order(x), for order 0 less 1 without cancellation."""
    if order > 0:
        return np.asarray(jv(order, x))
    series = x * x * (x * x / 64 - 0.25)
    return np.asarray(np.where(x < SMALL, series, jv(0, x) - 1.0))


def is_round_at_rest(model: LayDownModel) -> bool:
    """Whether the angular index is kept: B isotropic, and no belt that moves."""
    return bool(model.potential.isotropic) and model.curve.fixed


def at_rest(model: LayDownModel, k: Array, tolerance: float) -> tuple[Array, Array]:
    """Ŝ of long waves |k| > 0, and bounds of the errors, relative to each.

    Truncations grow as in `Ladder`, with the same bound of the error.

    Raises
    ------
    ToleranceError
        If the largest truncation is not fine enough.
    """
    coarse = AtRest(model, FIRST).spectrum(k)
    before = error = np.inf
    for level in range(1, LAST_LEVEL + 1):
        fine = AtRest(model, grown(FIRST, level)).spectrum(k)
        change = float(np.max(np.abs(fine / coarse - 1.0)))
        remembered = MEMORY * before if np.isfinite(before) else 0.0
        error = max(SAFETY * change, remembered, ROUNDING)
        if error <= tolerance:
            return fine, error * fine
        coarse, before = fine, change
    degree = grown(FIRST, LAST_LEVEL).degree
    remedy = f"raise `tolerance`: no truncation of degree {degree} is fine enough"
    sigma = throwing_range(radial_basis(model.potential, 1))
    if model.noise * sigma**0.5 < LOW_NOISE:
        remedy += f"; or the noise, with {model.noise:g} orbits last for long"
    raise ToleranceError(error, tolerance, remedy)
