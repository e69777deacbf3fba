"""Models as JSON-able dictionaries, and back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fpsolve.model.fibre import FibreModel
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.smooth import SmoothLayDownModel

__all__ = ["model_from_dict"]


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
