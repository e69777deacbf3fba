"""Coordinates in which a likelihood is nearly a parabola, and the parameters they are.

(1/σ1², 1/σ2², ln A), and ln R for the smooth model: the innovations of the filter are
linear in the first two, of either sign, and scale with A.
"""

from __future__ import annotations

import math

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.model.curves.curve import Curve
from fpsolve.model.fibre import FibreModel
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.studies.identification.chord_law import Parameters

__all__ = [
    "FUNCTIONAL",
    "LIKELIHOOD",
    "covariance_of",
    "interval",
    "logarithmic_interval",
    "model_at",
    "named",
    "parameters_at",
]

NAMES = ("sigma1", "sigma2", "noise", "curvature_noise")
# Powers of 1/σ in which the errors of a throwing range are even, by the method.
LIKELIHOOD, FUNCTIONAL = 2, 1


def parameters_at(coordinates: Array) -> Parameters:
    """What the coordinates stand for."""
    first, second, noise, *relaxation = (float(value) for value in coordinates)
    length = math.exp(relaxation[0]) if relaxation else 0.0
    return Parameters((first, second), math.exp(noise), length)


def named(coordinates: Array) -> dict[str, float]:
    """σ1, σ2, A and, of a smooth fibre, K = A/R; NaN for a σ that does not exist."""
    at = parameters_at(coordinates)
    ranges = [b**-0.5 if b > 0 else math.nan for b in at.strength]
    bent = [at.noise / at.relaxation_length] if at.relaxation_length else []
    return dict(zip(NAMES, [*ranges, at.noise, *bent], strict=False))


def covariance_of(coordinates: Array, covariance: Array) -> Array:
    """Covariance of the parameters from that of the coordinates, to first order.

    An infinite variance of ln R makes that of K infinite, and nothing else.
    """
    finite = np.where(np.isfinite(covariance), covariance, 0.0)
    values = named(coordinates)
    slopes = np.zeros((len(values), len(values)))
    for k, name in enumerate(("sigma1", "sigma2")):
        slopes[k, k] = -0.5 * values[name] ** 3
    slopes[2, 2] = values["noise"]
    if "curvature_noise" in values:
        slopes[3, 2], slopes[3, 3] = 1.0, -1.0
        slopes[3] *= values["curvature_noise"]
    found = slopes @ finite @ slopes.T
    if not np.isfinite(covariance).all():
        found[3], found[:, 3] = 0.0, 0.0
        found[3, 3] = math.inf
    return np.asarray(found)


def model_at(coordinates: Array, curve: Curve) -> FibreModel:
    """The model with these parameters."""
    at = parameters_at(coordinates)
    potential = QuadraticPotential(*(b**-0.5 for b in at.strength))
    if at.relaxation_length:
        return SmoothLayDownModel(potential, at.relaxation_length, at.noise, curve)
    return LayDownModel(potential, at.noise, curve)


def interval(
    name: str, value: float, error: float, deviations: float, power: int = LIKELIHOOD
) -> tuple[float, float]:
    """Value ± deviations · error, in the coordinate in which errors are even.

    In σ^(-power) for throwing ranges, up to infinity; in the logarithm for the noises.
    The likelihood is even in 1/σ², the strength of the force. The functional sees how
    wide a fibre lies: its relative error is that of as many lengths as the fibre
    remembers, A²σ² of it each where it is loud, so that it grows with σ and 1/σ has an
    error of its own size wherever σ is found.

    Parameters
    ----------
    name : str
        Of the parameter.
    value, error : float
        Of the parameter itself; the error to first order.
    deviations : float
        1.96 for 95 %.
    power : int
        `LIKELIHOOD` or `FUNCTIONAL`.
    """
    if not name.startswith("sigma"):
        return logarithmic_interval(value, error, deviations)
    share = power * deviations * error / value
    wide = 1 - share
    return (
        value * (1 + share) ** (-1 / power),
        value * wide ** (-1 / power) if wide > 0 else math.inf,
    )


def logarithmic_interval(
    value: float, error: float, deviations: float
) -> tuple[float, float]:
    """P exp(±z δP/P); of an error many times the parameter anything positive."""
    factor = math.exp(min(deviations * error / value, 700.0))
    return value / factor, value * factor
