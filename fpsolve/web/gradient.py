"""Derivatives of what is predicted in the parameters of the model and the spacing."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.spectral.resolvent.fibre import Differentiable, differentiable
from fpsolve.web.band_power import band_power
from fpsolve.web.coherent import Bounded
from fpsolve.web.coherent_gradient import ROUNDING, coherent_gradient, strip_gradient
from fpsolve.web.prediction import WebPrediction
from fpsolve.web.table import SpectrumTable
from fpsolve.web.zone_variance import zone_variance

__all__ = ["of_process", "with_gradient"]

# By parameter the power of the unit of length that it goes with; others are lengths.
POWERS = {"noise": -0.5, "belt_speed": 0.0}


def with_gradient(
    found: WebPrediction, table: SpectrumTable, variances: Bounded
) -> WebPrediction:
    """The prediction with ∂CV = ∂CV²/(2 CV) and the derivatives of all the rest.

    With all lengths in units of L, CV of A √L, v, σ/L, R/L, d/L and zones x/L is what
    it is of the parameters in another unit: with L fixed, derivatives are multiplied by
    √L for the noise, by 1/L for lengths, and by nothing for the speed.

    Parameters
    ----------
    found : WebPrediction
    table : SpectrumTable
        With derivatives.
    variances : (ndarray, ndarray)
        ∫ Ŝ … of each zone, and errors.
    """
    unit, spacing = found.length, found.spacing / found.length
    fibre = differentiable(table.source.ladder)
    squares = [
        square_gradient(table, spacing, float(side), found.positions, (value, error))
        for side, value, error in zip(found.zones / unit, *variances, strict=True)
    ]
    values, errors = np.moveaxis(np.array(squares), 0, 2) / (2 * found.cv)
    errors = errors + np.abs(values) * found.errors / found.cv
    strips = strip_gradient(fibre, spacing, found.strips.size)
    tensor = orientation_gradient(fibre)
    bands = np.stack([found.shortest, found.longest], axis=1) / unit
    powers = cloudiness_gradient(table, spacing, bands)
    names = (*fibre.parameters, "spacing")
    factors = np.array([unit ** -POWERS.get(name, 1.0) for name in names])
    return replace(
        found,
        parameters=names,
        gradient=factors[:, None] * values,
        gradient_errors=factors[:, None] * errors,
        strip_gradient=factors[:, None] * strips[0],
        strip_gradient_errors=factors[:, None] * strips[1],
        cloudiness_gradient=factors[:, None] * powers[0],
        cloudiness_gradient_errors=factors[:, None] * powers[1],
        orientation_gradient=factors[:, None, None] * tensor[0],
        orientation_gradient_errors=factors[:, None, None] * tensor[1],
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

    def integral(part: SpectrumTable) -> tuple[float, float]:
        change, by_axis, of_nodes = zone_variance(part, side)
        return change, sum(by_axis.values()) + of_nodes

    values, errors = power_gradient(table, spacing, integral, variance)
    fibre = differentiable(table.source.ladder)
    added, added_errors = coherent_gradient(fibre, spacing, side, positions)
    return values + added, errors + added_errors


def cloudiness_gradient(table: SpectrumTable, spacing: float, bands: Array) -> Bounded:
    """∂ of |v| d ∫ Ŝ d²k/(2π)² over every band, (parameter, band), the last in d."""
    shape = len(bands), len(differentiable(table.source.ladder).parameters) + 1
    values, errors = np.zeros((2, *shape))
    for place, (shortest, longest) in enumerate(bands.tolist()):
        integral = partial(band_power, longest=longest, shortest=shortest)
        found = power_gradient(table, spacing, integral, integral(table))
        values[place], errors[place] = found
    return values.T, errors.T


def power_gradient(
    table: SpectrumTable,
    spacing: float,
    integral: Callable[[SpectrumTable], tuple[float, float]],
    power: tuple[float, float],
) -> Bounded:
    """∂ of |v| d I, I an integral of Ŝ and so ∂I that of ∂Ŝ; the last one in d."""
    fibre = differentiable(table.source.ladder)
    n, speed = len(fibre.parameters), float(fibre.model.curve.speed)
    values, errors = np.zeros((2, n + 1))
    for parameter in range(n):
        change, error = integral(table.derivative(parameter))
        values[parameter] = abs(speed) * spacing * change
        errors[parameter] = abs(speed) * spacing * error
    # Of the factor |v| d itself.
    for place, factor in (
        (fibre.parameters.index("belt_speed"), math.copysign(spacing, speed)),
        (n, abs(speed)),
    ):
        values[place] += factor * power[0]
        errors[place] += abs(factor) * power[1]
    return values, errors


def orientation_gradient(fibre: Differentiable) -> Bounded:
    """∂⟨τ⊗τ⟩ = ± ∂E cos 2α/2, (parameter, 2, 2), the last one in d, which is zero."""
    fine, coarse = fibre.double_cosine_changes()
    error = np.append(np.abs(fine - coarse) + ROUNDING, 0.0)
    values = np.multiply.outer(np.append(0.5 * fine, 0.0), np.diag([1.0, -1.0]))
    return values, np.multiply.outer(error, np.eye(2))
