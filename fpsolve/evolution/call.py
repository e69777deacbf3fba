"""One way to say what was computed: a public function and its arguments."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.checks import shown
from fpsolve._support.declared import declared
from fpsolve._support.digests import digest_of
from fpsolve._support.labels import labels, to_json
from fpsolve._support.provenance import Stopwatch
from fpsolve.errors import RunError, RunInterrupted
from fpsolve.grids.cells import CellGrid
from fpsolve.grids.plane import PlaneGrid
from fpsolve.model.curves.curve import Curve
from fpsolve.model.curves.dictionaries import curve_to_dict
from fpsolve.model.fibre import FibreModel
from fpsolve.model.identity.digests import digest_or_none
from fpsolve.model.potentials.dictionaries import potential_to_dict
from fpsolve.model.potentials.potential import Potential

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "ARRAY",
    "CALL",
    "IDENTITY",
    "KEPT",
    "RESULT",
    "USER_CODE",
    "WHERE",
    "Call",
    "Kept",
    "described",
    "recorded",
]

Function = TypeVar("Function", bound=Callable[..., Any])
Arrays = dict[str, NDArray[Any]]

# Name of the attribute.
CALL = "call"
# An object is a dictionary with one key, its kind; JSON has no other way to say it.
USER_CODE, ARRAY, KEPT, _TUPLE = "$user_code", "$array", "$kept", "$tuple"
# A result of another call, that was an argument of this one.
RESULT = "$result"
# Beside the name of a user's code stands what it is, for a comparison to see.
IDENTITY = "identity"
# Arguments that only say where something is computed, or how it is told.
WHERE = frozenset(
    ("client", "workers", "directory", "progress", "memory_limit", "checkpoint")
)
# What JSON has of its own; looked for first, since most of a call is of these.
_PLAIN = frozenset((bool, int, float, str))
# Longer arrays are variables of the dataset.
_LONGEST = 256


@dataclass(frozen=True, eq=False)
class Call:
    """A public function and the arguments that decide what it computes.

    Attributes
    ----------
    function : str
        Its name; of a method with that of its class.
    arguments : mapping
        As JSON holds them; objects by their `to_dict`, long arrays by digest.
    arrays : mapping of ndarray
        The long ones, by the names that they have in a dataset; but those that the
        result holds anyway.
    """

    function: str
    arguments: Mapping[str, Any]
    arrays: Mapping[str, NDArray[Any]] = field(default_factory=dict)

    @classmethod
    def of(cls, function: str, arguments: Mapping[str, Any]) -> Call:
        """Describe a call; what only says where it is computed is left out."""
        arrays: Arrays = {}
        told = {
            name: described(value, name, arrays)
            for name, value in arguments.items()
            if name not in WHERE and value is not None
        }
        return cls(function, told, arrays)

    @classmethod
    def from_xarray(cls, dataset: xr.Dataset) -> Call | None:
        """Return the call in a dataset, or None if there is none.

        Raises
        ------
        ValueError
            If the attribute is none that `on` wrote.
        """
        content = declared({k: v for k, v in dataset.attrs.items() if k == CALL})
        if not content:
            return None
        content = content[CALL]
        if not {"function", "arguments"} <= content.keys():
            raise ValueError(
                f"`{CALL}` must name a function and its arguments, got "
                f"{shown(content)}."
            )
        named = set(_variables(content["arguments"]))
        arrays = {
            str(name): variable.to_numpy()
            for name, variable in dataset.data_vars.items()
            if name in named
        }
        return cls(content["function"], content["arguments"], arrays)

    def on(self, dataset: xr.Dataset) -> xr.Dataset:
        """Return the dataset with the call as an attribute, and its arrays."""
        about = {"function": self.function, "arguments": self.arguments}
        variables = {
            name: (
                tuple(f"{name}_{axis}" for axis in range(values.ndim)),
                values,
                labels(f"{name.replace('_', ' ')} of {self.function}"),
            )
            for name, values in self.arrays.items()
            if name not in dataset
        }
        return dataset.assign(variables).assign_attrs({CALL: to_json(about)})


@dataclass(frozen=True, eq=False)
class Kept:
    """An argument that the result holds, as an attribute of its own.

    Attributes
    ----------
    attribute : str
        Its place in the result, as "initial_density" or "initial.p".
    values : ndarray
    """

    attribute: str
    values: NDArray[Any]


def described(value: Any, name: str, arrays: Arrays) -> Any:
    """Return a value as JSON holds it; long arrays go into `arrays`.

    An object of a class that says in `_recorded` how it is called is described by its
    `_recorded_parts()`, or else its `to_dict()`. A class derived from it is not. A
    result is described by its own call.

    Parameters
    ----------
    value : object
    name : str
        Of the argument, from which long arrays get theirs.
    arrays : dict
    """
    if value is None or type(value) in _PLAIN:
        return value
    own = vars(type(value)).get("_recorded")
    if own is not None:
        parts = getattr(value, "_recorded_parts", None) or value.to_dict
        return {f"${own}": described(parts(), name, arrays)}
    if isinstance(value, Potential):
        return {"$potential": potential_to_dict(value)}
    if isinstance(value, Curve):
        return {"$curve": curve_to_dict(value)}
    if isinstance(value, FibreModel):
        return {"$model": value.to_dict()}
    if isinstance(value, CellGrid):
        kind = "plane" if isinstance(value, PlaneGrid) else "grid"
        return {f"${kind}": value.to_dict()}
    if isinstance(value, np.random.SeedSequence):
        return {"$seed": {"entropy": value.entropy,
                          "spawn_key": list(value.spawn_key)}}  # fmt: skip
    if isinstance(value, Mapping):
        return {
            str(key): described(one, f"{name}_{key}", arrays)
            for key, one in value.items()
        }
    if isinstance(value, list | tuple):
        return _series(value, name, arrays)
    if isinstance(getattr(value, "call", None), Call):
        return _result(value.call, arrays)
    if isinstance(value, Kept):
        return {KEPT: value.attribute, IDENTITY: digest_of(value.values)}
    if isinstance(value, np.ndarray) and value.dtype.kind in "biuf":
        return _array(value, name, arrays)
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, bool | int | float | str):
        return value
    code = getattr(value, "__qualname__", type(value).__qualname__)
    return {USER_CODE: code, IDENTITY: digest_or_none(value)}


def _result(call: Call, arrays: Arrays) -> Any:
    """How a result was made, which says what it is."""
    arrays.update(call.arrays)
    return {RESULT: {"function": call.function, "arguments": call.arguments}}


def _series(value: Any, name: str, arrays: Arrays) -> Any:
    if len(value) > _LONGEST and not any(isinstance(one, str) for one in value):
        return _array(np.asarray(value), name, arrays)
    parts = [described(one, f"{name}_{k}", arrays) for k, one in enumerate(value)]
    plain = not any(isinstance(one, dict | list) for one in parts)
    # A pair of numbers may be written either way.
    return {_TUPLE: parts} if isinstance(value, tuple) and not plain else parts


def _array(value: NDArray[Any], name: str, arrays: Arrays) -> Any:
    if value.ndim < 2 and value.size <= _LONGEST:
        return value.tolist()
    variable = f"argument_{name}"
    arrays[variable] = value
    return {ARRAY: variable, IDENTITY: digest_of(value)}


def _variables(told: Any) -> Iterator[Any]:
    """Names of the variables that hold arrays of a call."""
    if isinstance(told, dict):
        if ARRAY in told:
            yield told[ARRAY]
        told = list(told.values())
    for part in told if isinstance(told, list) else ():
        yield from _variables(part)


def recorded(**describers: Callable[[Any, Any], Any]) -> Callable[[Function], Function]:
    """Decorate a public function so that its result says how it was called.

    A dataclass gets `call`, and `provenance` if it has none; a dataset gets the
    attribute `call`. So does the partial result that an exception carries.

    Parameters
    ----------
    **describers : callable
        For an argument of that name a function of it, and of all by name, that returns
        what is described in its place.
    """

    def decorate(function: Function) -> Function:
        signature = inspect.signature(function)
        name = function.__qualname__

        @functools.wraps(function)
        def called(*args: Any, **options: Any) -> Any:
            try:
                bound = signature.bind(*args, **options)
            except TypeError:
                # Python's own words are better.
                return function(*args, **options)
            for key, value in bound.arguments.items():
                if isinstance(value, Iterator):
                    bound.arguments[key] = list(value)
            watch = Stopwatch()

            def told(result: Any) -> Any:
                bound.apply_defaults()
                arguments = _arguments(bound.arguments, describers)
                return _told(result, Call.of(name, arguments), watch)

            try:
                return told(function(*bound.args, **bound.kwargs))
            except (RunError, RunInterrupted) as error:
                if error.solution is not None:
                    error.solution = told(error.solution)
                raise

        return cast(Function, called)

    return decorate


def _arguments(
    bound: Mapping[str, Any], describers: Mapping[str, Callable[[Any, Any], Any]]
) -> dict[str, Any]:
    """What was given by name; for an object what it is made of."""
    arguments = {
        name: describers[name](value, bound) if name in describers else value
        for name, value in bound.items()
        if name != "self"
    }
    if "self" not in bound:
        return arguments
    made = inspect.signature(type(bound["self"])).parameters
    return {**{name: getattr(bound["self"], name) for name in made}, **arguments}


def _told(result: Any, call: Call, watch: Stopwatch) -> Any:
    if hasattr(result, "data_vars"):
        return call.on(result)
    fields = getattr(result, "__dataclass_fields__", {})
    added: dict[str, Any] = {"call": call} if "call" in fields else {}
    if "provenance" in fields and not result.provenance:
        added["provenance"] = watch.provenance()
    return replace(result, **added) if added else result
