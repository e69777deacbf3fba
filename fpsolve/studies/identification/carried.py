"""What the errors of identified parameters make of a predicted web."""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_kind
from fpsolve.model.fibre import FibreModel
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.web.prediction import WebPrediction

__all__ = ["Identified", "carried_errors", "why_not_carried"]

# Relative standard error of a parameter above which CV is not linear over it: the
# second order, δ²/2 of it, is then more than a twentieth.
LARGEST_ERROR = 0.3
# Relative difference of parameters that are the same ones, in another unit of length.
SAME = 1e-9


class Identified(Protocol):
    """What is asked here of an `Identification`, which has `carried_errors` itself."""

    @property
    def model(self) -> FibreModel:
        """With the parameters found."""

    @property
    def parameters(self) -> dict[str, float]:
        """By their names."""

    @property
    def covariance(self) -> Array:
        """Of the parameters in their order."""

    @property
    def standard_errors(self) -> dict[str, float]:
        """Square roots of the variances of the parameters."""

    @property
    def undetermined(self) -> dict[str, str]:
        """Parameters that the fibre cannot determine, and why."""


def why_not_carried(identification: Identified) -> str | None:
    """Why errors of these parameters cannot be carried to a prediction, or None."""
    for name, why in identification.undetermined.items():
        return f"{name} is not determined: {why}"
    for name, error in identification.standard_errors.items():
        value = identification.parameters[name]
        if not error <= LARGEST_ERROR * value:
            return (
                f"{name} has a standard error of {100 * error / value:.0f} %, over "
                "which the variation is not linear"
            )
    return None


def carried_errors(identification: Identified, prediction: WebPrediction) -> Array:
    """√(g Σ gᵀ) of every zone, g = ∂CV/∂(σ1, σ2, A) and Σ the covariance.

    Of smooth fibres g = ∂CV/∂(σ1, σ2, A, K): with R = A/K it is ∂_A + ∂_R/K at fixed K,
    and −(R/K) ∂_R at fixed A.

    Standard errors that CV has because the parameters were identified, besides the
    `errors` of the prediction itself. The rounding and truncation of g are added, so
    that they are not too small; what is left out is of second order in the relative
    errors of the parameters.

    Parameters
    ----------
    identification : Identification
    prediction : WebPrediction
        Of its model, with `gradients`.

    Raises
    ------
    ValueError
        If the prediction has no gradients or is of another model, or parameters are not
        determined, or not to 30 per cent.
    TypeError
        If it is no prediction.
    """
    check_kind("prediction", prediction, WebPrediction, "`predict_web` returns one")
    reason = why_not_carried(identification)
    if reason is not None:
        raise ValueError(
            f"`identification` must have errors that can be carried on, got {reason}; "
            "compare predictions for parameters at both ends of their intervals."
        )
    if prediction.gradient is None or prediction.gradient_errors is None:
        raise ValueError(
            "`prediction` must have gradients, got none; ask for them by "
            "`predict_web(..., gradients=True)`."
        )
    _check_same(identification, prediction)
    turn = in_identified(identification.parameters, prediction.parameters)
    slopes = turn @ prediction.gradient
    wrong = np.abs(turn) @ prediction.gradient_errors
    squares = np.einsum("iz,ij,jz->z", slopes, identification.covariance, slopes)
    deviations = np.sqrt(np.diag(identification.covariance))
    return np.asarray(np.sqrt(np.maximum(squares, 0.0)) + deviations @ wrong)


def in_identified(values: dict[str, float], names: tuple[str, ...]) -> Array:
    """Matrix from derivatives in parameters of a prediction to those identified.

    Parameters
    ----------
    values : dict of float
        Identified parameters, which have K where the predicted ones have R.
    names : tuple of str
        Of the prediction.
    """
    turn = np.zeros((len(values), len(names)))
    for row, name in enumerate(values):
        if name in names:
            turn[row, names.index(name)] = 1.0
    if "curvature_noise" in values:
        order, by_length = list(values), names.index("relaxation_length")
        noise, curvature = values["noise"], values["curvature_noise"]
        turn[order.index("noise"), by_length] = 1.0 / curvature
        turn[order.index("curvature_noise"), by_length] = -noise / curvature**2
    return turn


def _check_same(identification: Identified, prediction: WebPrediction) -> None:
    """Raise ValueError unless both have the same parameters, in whatever unit."""
    model, length = prediction.model, prediction.length
    assert model is not None
    assert isinstance(model.potential, QuadraticPotential)
    predicted = {
        "sigma1": length * model.potential.sigma1,
        "sigma2": length * model.potential.sigma2,
        "noise": model.noise / math.sqrt(length),
    }
    if isinstance(model, SmoothLayDownModel):
        predicted["curvature_noise"] = model.curvature_noise / length**1.5
    if predicted.keys() != identification.parameters.keys():
        raise ValueError(
            "`prediction` must be of the identified model, got one with "
            f"{', '.join(predicted)} and identified "
            f"{', '.join(identification.parameters)}; predict `identification.model`."
        )
    for name, value in identification.parameters.items():
        if not abs(predicted[name] - value) <= SAME * value:
            raise ValueError(
                f"`prediction` must be of the identified model, got one of {name} = "
                f"{predicted[name]:g} and identified {value:g}; predict "
                "`identification.model`."
            )
