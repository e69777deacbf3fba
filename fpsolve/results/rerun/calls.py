"""Repeat a result that says how it was called."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from fpsolve._support.checks import shown
from fpsolve.errors import NotRepeatableError
from fpsolve.evolution.call import Call
from fpsolve.results.kinds import KINDS, kind_of, named
from fpsolve.results.rerun.arguments import OfOwner, arguments_of
from fpsolve.results.rerun.costs import check_call
from fpsolve.results.rerun.missing import unrecorded

__all__ = ["repeat_call"]

# What the command line adds.
_NOTES = ("command", "configuration", "suggested")


def repeat_call(result: Any, overrides: dict[str, Any]) -> Any:
    """Call the function of a result as it was called, with the overrides."""
    place = KINDS[kind_of(result)].function
    name = place.partition(":")[2] if isinstance(place, str) else place.__qualname__
    call = _call_of(result)
    if call is None:
        raise unrecorded("how it was computed", f"`{name}`")
    if call.function != name:
        raise NotRepeatableError(
            f"the result must be made by {name} to be repeated, got "
            f"{call.function!r}; update fpsolve."
        )
    arguments = arguments_of(call, overrides, result)
    check_call(name, arguments, result, overrides)
    return _noted(result, _called(place, arguments, overrides), call)


def _called(
    place: str | Callable[..., Any], arguments: dict[str, Any], given: Mapping[str, Any]
) -> Any:
    """The value of a function, or of a method of an object made for it."""
    if not isinstance(place, str) or "." not in place.partition(":")[2]:
        function = named(place)
        return function(**_known(function, arguments, given))
    module, _, name = place.partition(":")
    owner, _, method = name.rpartition(".")
    kind = named(f"{module}:{owner}")
    own = inspect.signature(kind).parameters
    made = kind(**{name: arguments.pop(name) for name in own if name in arguments})
    function = getattr(made, method)
    return function(**{
        name: getattr(made, one.method)(**one.options) if isinstance(one, OfOwner)
        else one
        for name, one in _known(function, arguments, given).items()
    })  # fmt: skip


def _known(
    function: Callable[..., Any], arguments: dict[str, Any], given: Mapping[str, Any]
) -> dict[str, Any]:
    """The arguments; NotRepeatableError for one that the function does not have."""
    known = inspect.signature(function).parameters
    unknown = arguments.keys() - known.keys() - given.keys()
    if unknown:
        raise NotRepeatableError(
            f"the result must be made with the arguments {', '.join(known)} to be "
            f"repeated, got {shown(sorted(unknown)[0])}; update fpsolve."
        )
    return arguments


def _call_of(result: Any) -> Call | None:
    if hasattr(result, "data_vars"):
        return Call.from_xarray(result)
    call: Call | None = result.call
    return call


def _noted(old: Any, new: Any, call: Call) -> Any:
    """The new result, if of the same call with what a command wrote beside it."""
    again = _call_of(new)
    if again is None or again.arguments != call.arguments:
        return new
    if hasattr(old, "data_vars"):
        return new.assign_attrs({n: old.attrs[n] for n in _NOTES if n in old.attrs})
    notes = {n: old.provenance[n] for n in _NOTES if n in old.provenance}
    return replace(new, provenance={**new.provenance, **notes}) if notes else new
