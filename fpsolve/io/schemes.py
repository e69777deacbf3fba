"""Schemes as dictionaries, and back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fpsolve.grids import PhaseSpaceGrid
from fpsolve.models import LayDownModel
from fpsolve.schemes import drift_kick, semi_lagrangian
from fpsolve.solve import Scheme

__all__ = ["describe_scheme", "scheme_from_dict"]

_MAKERS: dict[str, Any] = {"drift_kick": drift_kick, "semi_lagrangian": semi_lagrangian}


def describe_scheme(scheme: Scheme) -> dict[str, Any]:
    """Name, order and options of a scheme, ready for JSON."""
    return {
        "name": scheme.name,
        "order": scheme.order,
        "options": dict(scheme.options),
    }


def scheme_from_dict(
    description: Mapping[str, Any], model: LayDownModel, grid: PhaseSpaceGrid
) -> Scheme:
    """Return the scheme that `describe_scheme` described.

    Raises
    ------
    ValueError
        If it is none of fpsolve.
    """
    name = description["name"]
    if name not in _MAKERS:
        known = ", ".join(repr(one) for one in _MAKERS)
        raise ValueError(f"`scheme` must be one of {known}, got {name!r}.")
    scheme: Scheme = _MAKERS[name](model, grid, **description["options"])
    return scheme
