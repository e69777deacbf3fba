"""The arguments of a call, made again from what a result says of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fpsolve.density.schemes.dictionaries import scheme_from_dict
from fpsolve.evolution.call import ARRAY, USER_CODE, Call
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.plane import PlaneGrid
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.dictionaries import potential_from_dict
from fpsolve.paths.law_dataset import law_from_formula
from fpsolve.paths.laws import DensityLaw
from fpsolve.results.rerun.missing import own_code
from fpsolve.spectral.bases.sectors import Sector

__all__ = ["READERS", "OfOwner", "arguments_of"]


@dataclass(frozen=True)
class OfOwner:
    """An argument that the object makes whose method is called.

    Attributes
    ----------
    method : str
    options : dict
    """

    method: str
    options: Mapping[str, Any]


def _seed(about: Mapping[str, Any]) -> np.random.SeedSequence:
    spawned = tuple(about["spawn_key"])
    return np.random.SeedSequence(about["entropy"], spawn_key=spawned)


def _scheme(about: Mapping[str, Any]) -> Any:
    return scheme_from_dict(about["scheme"], about["model"], about["grid"])


# What an object is called in a call, and what makes it of its parts.
READERS: dict[str, Callable[[Any], Any]] = {
    "$potential": potential_from_dict,
    "$model": LayDownModel.from_dict,
    "$grid": PhaseSpaceGrid.from_dict,
    "$plane": PlaneGrid.from_dict,
    "$law": law_from_formula,
    "$density_law": lambda about: DensityLaw(about["grid"], about["p"]),
    "$sector": lambda about: Sector(**about),
    "$scheme": _scheme,
    "$seed": _seed,
    "$energy_grid": lambda about: OfOwner("grid", about),
    "$tuple": tuple,
}


def arguments_of(call: Call, given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the arguments of a call, those that are given in their place.

    Raises
    ------
    NotRepeatableError
        If an argument that is not given was a user's own code.
    """
    kept = {
        name: _read(name, value, call.arrays)
        for name, value in call.arguments.items()
        if name not in given
    }
    return {**kept, **given}


def _read(argument: str, value: Any, arrays: Mapping[str, Any]) -> Any:
    """Return what `described` described."""
    if isinstance(value, list):
        return [_read(argument, one, arrays) for one in value]
    if not isinstance(value, dict):
        return value
    if USER_CODE in value:
        raise own_code(argument, str(value[USER_CODE]))
    if ARRAY in value:
        return arrays[value[ARRAY]]
    parts = {name: _read(argument, one, arrays) for name, one in value.items()}
    kind = next(iter(parts), "")
    if len(parts) > 1 or kind not in READERS:
        return parts
    try:
        return READERS[kind](parts[kind])
    except KeyError as error:
        raise own_code(argument, f"without {error}") from None
    except (ValueError, TypeError) as error:
        raise own_code(argument, str(error)) from None
