"""Derivatives of what the mean of every fibre adds to a web."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.spectral.resolvent.fibre import Differentiable
from fpsolve.web.coherent import END, Bounded, harmonics_of
from fpsolve.web.zone_variance import window_integrals

__all__ = ["coherent_gradient", "strip_gradient"]

# What rounding leaves of φ and its derivatives, which are of the size of one.
ROUNDING = 1e-13


def coherent_gradient(
    fibre: Differentiable, spacing: float, side: float, positions: str
) -> Bounded:
    """∂ of the coherent part of CV², in the parameters of the fibre and in d."""
    of = {"regular": of_regular, "random": of_random}[positions]
    return of(fibre, spacing, side)


def of_regular(fibre: Differentiable, spacing: float, side: float) -> Bounded:
    """∂ Σ 2 |φ(0, k_j)|² sinc²(k_j x/2), k_j = 2πj/d, also in d."""
    n = max(1, int(END * spacing / (2 * np.pi * fibre.scales[1])))
    means = Means.of(fibre, harmonics_of(spacing, n))
    z = 0.5 * means.k2 * side
    window = np.sinc(z / np.pi)
    # Both k_j and z go with 1/d.
    by_d = -2 * window * (np.cos(z) - window) / spacing
    changes, errors = means.with_spacing(spacing)
    values, bounds = 2 * means.phi * changes, means.square_errors(changes, errors)
    values, bounds = 2 * values @ window**2, 2 * bounds @ window**2
    values[-1] += 2 * means.phi**2 @ by_d
    bounds[-1] += 4 * (np.abs(means.phi) * means.error) @ np.abs(by_d)
    return values, bounds


def of_random(fibre: Differentiable, spacing: float, side: float) -> Bounded:
    """∂ d ∫ |φ(0, k2)|² sinc²(k2 x/2) dk2/2π, which is proportional to d."""
    k2, weights = window_integrals(side, 0.0, END / fibre.scales[1])
    means = Means.of(fibre, k2)
    values = 2 * means.phi * means.changes
    errors = means.square_errors(means.changes, means.change_errors)
    values[-1] = means.phi**2 / spacing
    errors[-1] = 2 * np.abs(means.phi) * means.error / spacing
    factor = spacing / np.pi
    return factor * values @ weights, factor * errors @ weights


def strip_gradient(fibre: Differentiable, spacing: float, n: int) -> Bounded:
    """∂ 2 |φ(0, 2πj/d)|, (parameter, j), the last one in d.

    Where φ is not known to be another number than zero, its sign is not, either.
    """
    means = Means.of(fibre, harmonics_of(spacing, n))
    changes, errors = means.with_spacing(spacing)
    unknown = np.where(np.abs(means.phi) > means.error, 0.0, 2 * np.abs(changes))
    return 2 * np.sign(means.phi) * changes, 2 * (errors + unknown)


@dataclass(frozen=True)
class Means:
    """φ(0, k2), which is real, and its derivatives in the parameters and in k2.

    Attributes
    ----------
    k2, phi, error : ndarray, shape (k,)
    changes, change_errors : ndarray, shape (parameter + 1, k)
        The last ones in k2.
    """

    k2: Array
    phi: Array
    error: Array
    changes: Array
    change_errors: Array

    @classmethod
    def of(cls, fibre: Differentiable, k2: Array) -> Means:
        """From two truncations, whose difference counts twice."""
        fine, coarse = fibre.characteristic_changes(k2)
        errors = 2 * np.abs(fine - coarse) + ROUNDING
        return cls(k2, fine[0], errors[0], fine[1:], errors[1:])

    def with_spacing(self, spacing: float) -> Bounded:
        """Derivatives where the k_j = 2πj/d go with 1/d, the last ones in d."""
        changes, errors = self.changes.copy(), self.change_errors.copy()
        changes[-1] *= -self.k2 / spacing
        errors[-1] *= self.k2 / spacing
        return changes, errors

    def square_errors(self, changes: Array, errors: Array) -> Array:
        """Of 2 φ ∂φ."""
        return 2 * (np.abs(self.phi) * errors + self.error * (np.abs(changes) + errors))
