"""Models from dictionaries, and from the numbers that a file gives."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fpsolve.model.curves.belts import FixedBelt
from fpsolve.model.curves.curve import Curve
from fpsolve.model.fibre import FibreModel
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.potential import Potential
from fpsolve.model.smooth import SmoothLayDownModel

__all__ = ["make_model", "model_from_dict"]


def model_from_dict(description: Mapping[str, Any]) -> FibreModel:
    """Return the model that its `to_dict` described: a smooth one has a length R.

    Raises
    ------
    ValueError
        If a kind or a parameter is unknown, or potential or curve are a user's own.
    """
    if "relaxation_length" in description:
        return SmoothLayDownModel.from_dict(description)
    return LayDownModel.from_dict(description)


def make_model(
    potential: Potential,
    noise: float | None = None,
    curve: Curve | None = None,
    relaxation_length: float | None = None,
    curvature_noise: float | None = None,
) -> FibreModel:
    """Return the smooth model if there is a relaxation length, else the basic one.

    Raises
    ------
    ValueError
        If the noise is missing, or is that of a curvature without a length.
    """
    curve = FixedBelt() if curve is None else curve
    if relaxation_length is not None:
        return SmoothLayDownModel(
            potential, relaxation_length, noise, curve, curvature_noise=curvature_noise
        )
    if curvature_noise is not None:
        raise ValueError(
            "`relaxation_length` must be given with `curvature_noise`, got none; the "
            "basic model has the `noise` of the angle."
        )
    if noise is None:
        raise ValueError("`noise` must be given, got none; 0 means no noise.")
    return LayDownModel(potential, noise, curve)
