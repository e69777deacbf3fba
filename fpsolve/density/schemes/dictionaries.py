"""Schemes from the dictionaries that describe them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fpsolve.density.description import CODE
from fpsolve.density.schemes.known import SCHEMES
from fpsolve.density.schemes.scheme import Scheme
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel

__all__ = ["scheme_from_dict"]


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
    if CODE in description:
        raise ValueError(
            f"`scheme` must be one of fpsolve, got a class of your own that calls "
            f"itself {name!r}."
        )
    if name not in SCHEMES:
        known = ", ".join(repr(one) for one in SCHEMES)
        raise ValueError(f"`scheme` must be one of {known}, got {name!r}.")
    scheme: Scheme = SCHEMES[name](model, grid, **description["options"])
    return scheme
