"""Derivatives of what is predicted in the parameters of the model and the spacing."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.spectral.resolvent.fibre import COARSE, FINE, differentiable
from fpsolve.spectral.resolvent.generator import Generator
from fpsolve.spectral.resolvent.ladder import Ladder
from fpsolve.spectral.resolvent.plane_waves import plane_wave, wave_derivative
from fpsolve.web.coherent import END, Bounded, harmonics_of
from fpsolve.web.prediction import WebPrediction
from fpsolve.web.table import SpectrumTable
from fpsolve.web.zone_variance import window_integrals, zone_variance

__all__ = ["PARAMETERS", "of_process", "with_gradient"]

PARAMETERS = (*Generator.parameters, "spacing")

# What rounding leaves of φ and its derivatives, which are of the size of one.
ROUNDING = 1e-13


def with_gradient(
    found: WebPrediction, table: SpectrumTable, variances: Bounded
) -> WebPrediction:
    """The prediction with ∂CV = ∂CV²/(2 CV) and the derivatives of the strips.

    With all lengths in units of L, CV of A √L, v, σ/L, d/L and zones x/L is what it is
    of the parameters in another unit: with L fixed, derivatives are multiplied by √L
    for the noise, by 1/L for lengths, and by nothing for the speed.

    Parameters
    ----------
    found : WebPrediction
    table : SpectrumTable
        With derivatives.
    variances : (ndarray, ndarray)
        ∫ Ŝ … of each zone, and errors.
    """
    unit, spacing = found.length, found.spacing / found.length
    squares = [
        square_gradient(table, spacing, float(side), found.positions, (value, error))
        for side, value, error in zip(found.zones / unit, *variances, strict=True)
    ]
    values, errors = np.moveaxis(np.array(squares), 0, 2) / (2 * found.cv)
    errors = errors + np.abs(values) * found.errors / found.cv
    strips = strip_gradient(
        differentiable(table.source.ladder), spacing, found.strips.size
    )
    factors = np.array([[math.sqrt(unit), 1.0, *(1 / unit,) * 3]]).T
    return replace(
        found,
        parameters=PARAMETERS,
        gradient=factors * values,
        gradient_errors=factors * errors,
        strip_gradient=factors * strips[0],
        strip_gradient_errors=factors * strips[1],
    )


def of_process(found: WebPrediction) -> WebPrediction:
    """The speed of the belt is the `speed_ratio` of a process."""
    names = (
        "speed_ratio" if name == "belt_speed" else name for name in found.parameters
    )
    return replace(found, parameters=tuple(names))


def square_gradient(
    table: SpectrumTable,
    spacing: float,
    side: float,
    positions: str,
    variance: tuple[float, float],
) -> Bounded:
    """∂CV² of a zone, CV² = |v| d I + C with I of Ŝ and C of the means of fibres."""
    ladder = differentiable(table.source.ladder)
    n = len(Generator.parameters)
    speed = float(ladder.model.curve.speed)
    values, errors = np.zeros((2, n + 1))
    for parameter in range(n):
        change, by_axis, of_nodes = zone_variance(table.derivative(parameter), side)
        values[parameter] = abs(speed) * spacing * change
        errors[parameter] = abs(speed) * spacing * (sum(by_axis.values()) + of_nodes)
    # Of the factor |v| d itself.
    for place, factor in (
        (Generator.parameters.index("belt_speed"), np.sign(speed) * spacing),
        (n, abs(speed)),
    ):
        values[place] += factor * variance[0]
        errors[place] += abs(factor) * variance[1]
    coherent = {"regular": of_regular, "random": of_random}[positions]
    added, added_errors = coherent(ladder, spacing, side)
    return values + added, errors + added_errors


def of_regular(ladder: Ladder, spacing: float, side: float) -> Bounded:
    """∂ Σ 2 |φ(0, k_j)|² sinc²(k_j x/2), k_j = 2πj/d, also in d."""
    n = max(1, int(END * spacing / (2 * np.pi * ladder.scales[1])))
    means = Means.of(ladder, harmonics_of(spacing, n))
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


def of_random(ladder: Ladder, spacing: float, side: float) -> Bounded:
    """∂ d ∫ |φ(0, k2)|² sinc²(k2 x/2) dk2/2π, which is proportional to d."""
    k2, weights = window_integrals(side, 0.0, END / ladder.scales[1])
    means = Means.of(ladder, k2)
    values = 2 * means.phi * means.changes
    errors = means.square_errors(means.changes, means.change_errors)
    values[-1] = means.phi**2 / spacing
    errors[-1] = 2 * np.abs(means.phi) * means.error / spacing
    factor = spacing / np.pi
    return factor * values @ weights, factor * errors @ weights


def strip_gradient(ladder: Ladder, spacing: float, n: int) -> Bounded:
    """∂ 2 |φ(0, 2πj/d)|, (parameter, j), the last one in d.

    Where φ is not known to be another number than zero, its sign is not, either.
    """
    means = Means.of(ladder, harmonics_of(spacing, n))
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
    def of(cls, ladder: Ladder, k2: Array) -> Means:
        """From two truncations, whose difference counts twice."""
        n_rows = 2 + len(Generator.parameters)
        fine, coarse = (
            np.array([means_of(ladder.generator(basis), k) for k in k2.tolist()])
            .reshape(k2.size, n_rows)
            .T
            for basis in (FINE, COARSE)
        )
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


def means_of(generator: Generator, k: float) -> Array:
    """φ(0, k) and its derivatives, of one truncation."""
    wave = plane_wave(generator, (0.0, k))
    phi = generator.stationary @ wave
    by_k = generator.stationary @ wave_derivative(generator, k)
    return np.array([phi, *(generator.stationary_derivatives @ wave), by_k]).real
