"""How a study is repeated: the function and its arguments, as JSON in an attribute."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from fpsolve._support.checks import shown
from fpsolve._support.declared import declared
from fpsolve._support.labels import to_json
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.plane import PlaneGrid
from fpsolve.model.identity.digests import digest_or_none
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.dictionaries import (
    potential_from_dict,
    potential_to_dict,
)
from fpsolve.model.potentials.potential import Potential
from fpsolve.paths.law_dataset import FORMULAS, law_from_formula

__all__ = ["RECIPE", "UserCodeError", "read_recipe", "recipe"]

# Name of the attribute.
RECIPE = "repeat"
# An object is a dictionary with one key, its kind; JSON has no other way to say it.
_MARK = "$"
# Beside the name of a user's code stands what it is, for a comparison to see.
_USER_CODE, _IDENTITY = f"{_MARK}user_code", "identity"
_READERS: dict[str, Callable[[Any], Any]] = {
    f"{_MARK}potential": potential_from_dict,
    f"{_MARK}model": LayDownModel.from_dict,
    f"{_MARK}grid": PhaseSpaceGrid.from_dict,
    f"{_MARK}plane": PlaneGrid.from_dict,
    f"{_MARK}law": law_from_formula,
    f"{_MARK}seed": lambda seed: np.random.SeedSequence(
        seed["entropy"], spawn_key=tuple(seed["spawn_key"])
    ),
}


class UserCodeError(ValueError):
    """An argument was a user's own code, which no file can hold.

    Parameters
    ----------
    argument : str
    description : str
        What is known of it.
    """

    def __init__(self, argument: str, description: str) -> None:
        super().__init__(f"`{argument}` was your own code, {description}")
        self.argument, self.description = argument, description


def recipe(function: str, arguments: Mapping[str, Any]) -> dict[str, str]:
    """Return the attribute that says how to compute this again.

    Parameters
    ----------
    function : str
        Name by which `rerun` knows it.
    arguments : mapping
        Keywords; what only decides where it is computed is left out.
    """
    described = {name: _described(value) for name, value in arguments.items()}
    return {RECIPE: to_json({"function": function, "arguments": described})}


def read_recipe(text: str, given: Mapping[str, Any]) -> tuple[str, dict[str, Any]]:
    """Return the function and its arguments, those that are given in their place.

    Raises
    ------
    UserCodeError
        If an argument that is not given was a user's own code.
    ValueError
        If the text is none that `recipe` wrote.
    """
    content = declared({RECIPE: text})[RECIPE]
    if not {"function", "arguments"} <= content.keys():
        raise ValueError(
            f"`{RECIPE}` must name a function and its arguments, got {shown(content)}."
        )
    arguments = {
        name: given[name] if name in given else _read(name, value)
        for name, value in content["arguments"].items()
    }
    return str(content["function"]), {**arguments, **given}


def _described(value: Any) -> Any:
    """Return the value as JSON holds it."""
    if isinstance(value, Potential):
        return {f"{_MARK}potential": potential_to_dict(value)}
    if isinstance(value, LayDownModel):
        return {f"{_MARK}model": value.to_dict()}
    if isinstance(value, PhaseSpaceGrid | PlaneGrid):
        kind = "plane" if isinstance(value, PlaneGrid) else "grid"
        return {f"{_MARK}{kind}": value.to_dict()}
    if type(value) in FORMULAS:
        return {f"{_MARK}law": value.to_dict()}
    if isinstance(value, np.random.SeedSequence):
        return {f"{_MARK}seed": {"entropy": value.entropy,
                                 "spawn_key": list(value.spawn_key)}}  # fmt: skip
    if isinstance(value, Mapping):
        return {str(name): _described(one) for name, one in value.items()}
    if isinstance(value, list | tuple):
        return [_described(one) for one in value]
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if value is None or isinstance(value, bool | int | float | str):
        return value
    name = getattr(value, "__qualname__", type(value).__qualname__)
    return {_USER_CODE: name, _IDENTITY: digest_or_none(value)}


def _read(argument: str, value: Any) -> Any:
    """Return what `_described` described; UserCodeError names the argument."""
    if isinstance(value, list):
        return [_read(argument, one) for one in value]
    if not isinstance(value, dict):
        return value
    if _USER_CODE in value:
        raise UserCodeError(argument, str(value[_USER_CODE]))
    kind = next(iter(value), "")
    if len(value) == 1 and kind in _READERS:
        try:
            return _READERS[kind](value[kind])
        except KeyError as error:
            raise UserCodeError(argument, f"without {error}") from None
        except (ValueError, TypeError) as error:
            raise UserCodeError(argument, str(error)) from None
    return {name: _read(argument, one) for name, one in value.items()}
