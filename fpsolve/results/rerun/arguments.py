"""The arguments of a call, made again from what a result says of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from operator import attrgetter
from typing import Any

import numpy as np

from fpsolve.density.schemes.dictionaries import scheme_from_dict
from fpsolve.errors import NotRepeatableError
from fpsolve.evolution.call import ARRAY, KEPT, RESULT, USER_CODE, Call
from fpsolve.fibre.air import AirFlow
from fpsolve.fibre.ends import Belt
from fpsolve.fibre.random_force import RandomForce
from fpsolve.fibre.string import String
from fpsolve.fibre.turbulent_force import TurbulentForce
from fpsolve.grids.dictionaries import grid_from_dict
from fpsolve.grids.plane import PlaneGrid
from fpsolve.model.curves.dictionaries import curve_from_dict
from fpsolve.model.potentials.dictionaries import potential_from_dict
from fpsolve.model.process import Process
from fpsolve.model.reading import model_from_dict
from fpsolve.paths.fibres.fibre_curve import FibreCurve
from fpsolve.paths.law_dataset import law_from_formula
from fpsolve.paths.laws import DensityLaw
from fpsolve.results.rerun.calling import OfOwner, result_of
from fpsolve.spectral.bases.sectors import Sector

__all__ = ["READERS", "arguments_of", "unrecorded"]

# Characters of a description that a message shows.
_LONGEST = 120


def _seed(about: Mapping[str, Any]) -> np.random.SeedSequence:
    spawned = tuple(about["spawn_key"])
    return np.random.SeedSequence(about["entropy"], spawn_key=spawned)


def _scheme(about: Mapping[str, Any]) -> Any:
    return scheme_from_dict(about["scheme"], about["model"], about["grid"])


_SCHEME, _MODEL = "$scheme", "$model"
# What an object is called in a call, and what makes it of its parts.
READERS: dict[str, Callable[[Any], Any]] = {
    "$potential": potential_from_dict,
    "$curve": curve_from_dict,
    "$fibre_curve": lambda about: FibreCurve(**about),
    _MODEL: model_from_dict,
    "$grid": grid_from_dict,
    "$plane": PlaneGrid.from_dict,
    "$law": law_from_formula,
    "$density_law": lambda about: DensityLaw(about["grid"], about["p"]),
    "$process": lambda about: Process(**about),
    "$sector": lambda about: Sector(**about),
    _SCHEME: _scheme,
    "$seed": _seed,
    "$string": String.from_dict,
    "$belt": lambda about: Belt(**about),
    "$air": lambda about: AirFlow(**about),
    "$turbulent_force": lambda about: TurbulentForce(**about),
    "$random_force": lambda about: RandomForce(**about),
    "$energy_grid": lambda about: OfOwner("grid", about),
    RESULT: result_of,
    "$tuple": tuple,
}


def arguments_of(
    call: Call, given: Mapping[str, Any], result: Any = None
) -> dict[str, Any]:
    """Return the arguments of a call, those that are given in their place.

    For a scheme, its model and its grid may be given as well.

    Parameters
    ----------
    call : Call
    given : mapping
    result : object, optional
        The result of the call, which may hold some of them.

    Raises
    ------
    NotRepeatableError
        If an argument that is not given was a user's own code.
    """
    reading = _Reading(call, given, result)
    kept = {
        name: reading.of(name, value)
        for name, value in call.arguments.items()
        if name not in given
    }
    own = {name: one for name, one in given.items()
           if name in call.arguments or name not in reading.used}  # fmt: skip
    return {**kept, **own}


@dataclass
class _Reading:
    """What `described` described, read again.

    Attributes
    ----------
    used : set of str
        Those of the given arguments that are parts of a scheme now.
    """

    call: Call
    given: Mapping[str, Any]
    result: Any
    used: set[str] = field(default_factory=set)

    def of(self, argument: str, value: Any) -> Any:
        """Return what a value in the call stands for."""
        if isinstance(value, list):
            return [self.of(argument, one) for one in value]
        if not isinstance(value, dict):
            return value
        if KEPT in value:
            return self._kept(argument, value)
        if USER_CODE in value:
            raise _own_code(argument, str(value[USER_CODE]))
        if ARRAY in value:
            return self.call.arrays[value[ARRAY]]
        kind = next(iter(value), "")
        if kind == _SCHEME and isinstance(value[kind], dict):
            return self._made(kind, argument, self._parts_of_scheme(value[kind]))
        parts = {name: self.of(argument, one) for name, one in value.items()}
        if len(parts) > 1 or kind not in READERS:
            return parts
        return self._made(kind, argument, parts[kind])

    def _parts_of_scheme(self, about: Mapping[str, Any]) -> dict[str, Any]:
        self.used |= about.keys() & self.given.keys()
        return {name: self.given[name] if name in self.given else self.of(name, one)
                for name, one in about.items()}  # fmt: skip

    def _kept(self, argument: str, value: Mapping[str, Any]) -> Any:
        """What the result holds; a user's own code only until it is written."""
        try:
            held = attrgetter(str(value[KEPT]))(self.result)
        except AttributeError:
            held = None
        code = USER_CODE in value
        if isinstance(held, np.ndarray) or (code and held is not None):
            return held
        if code:
            raise _own_code(argument, str(value[USER_CODE]))
        raise unrecorded(f"its `{argument}`", f"`{self.call.function}`")

    def _made(self, kind: str, argument: str, about: Any) -> Any:
        try:
            return READERS[kind](about)
        except KeyError as error:
            raise _own_code(argument, f"without {error}") from None
        except (ValueError, TypeError) as error:
            known = getattr(self.result, "model", None)
            # What was not written to a file yet may have a user's functions.
            if kind == _MODEL and known is not None:
                return known
            raise _own_code(argument, str(error)) from None


def _own_code(argument: str, description: str) -> NotRepeatableError:
    """Return the error for an argument that was a user's own code."""
    text = description if len(description) <= _LONGEST else f"{description[:118]} …"
    known = f" ({text})" if text else ""
    return NotRepeatableError(
        f"`{argument}` was your own code{known}, which no file holds; pass it as "
        f"`fpsolve.rerun(file, {argument}=...)`."
    )


def unrecorded(what: str, function: str) -> NotRepeatableError:
    """Return the error for a result that does not say enough."""
    return NotRepeatableError(
        f"the result does not say {what}; it was put together by hand. "
        f"Call {function} again and save the result."
    )
