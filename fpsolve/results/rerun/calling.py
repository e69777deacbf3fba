"""Call the function of a result again, or a method of what it was a method of."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from fpsolve._support.checks import shown
from fpsolve.errors import NotRepeatableError
from fpsolve.results.kinds import KINDS, named

__all__ = ["OfOwner", "called", "name_of", "result_of"]


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


def name_of(place: str | Callable[..., Any]) -> str:
    """What a call says of the function, or of the method with its class."""
    return place.partition(":")[2] if isinstance(place, str) else place.__qualname__


def result_of(about: Mapping[str, Any]) -> Any:
    """The result of a function and its arguments, which was an argument itself.

    Raises
    ------
    ValueError
        If no kind of result is made by it.
    """
    name = about["function"]
    places = {name_of(kind.function): kind.function for kind in KINDS.values()}
    if name not in places:
        raise ValueError(f"made by {name!r}, which this version does not know")
    return called(places[name], dict(about["arguments"]), {})


def called(
    place: str | Callable[..., Any], arguments: dict[str, Any], given: Mapping[str, Any]
) -> Any:
    """The value of a function, or of a method of an object made for it."""
    if not isinstance(place, str) or "." not in place.partition(":")[2]:
        function = named(place)
        return function(**known(function, arguments, given))
    module, _, name = place.partition(":")
    owner, _, method = name.rpartition(".")
    kind = named(f"{module}:{owner}")
    own = inspect.signature(kind).parameters
    made = kind(**{name: arguments.pop(name) for name in own if name in arguments})
    function = getattr(made, method)
    return function(**{
        name: getattr(made, one.method)(**one.options) if isinstance(one, OfOwner)
        else one
        for name, one in known(function, arguments, given).items()
    })  # fmt: skip


def known(
    function: Callable[..., Any], arguments: dict[str, Any], given: Mapping[str, Any]
) -> dict[str, Any]:
    """The arguments; NotRepeatableError for one that the function does not have."""
    has = inspect.signature(function).parameters
    unknown = arguments.keys() - has.keys() - given.keys()
    if unknown:
        raise NotRepeatableError(
            f"the result must be made with the arguments {', '.join(has)} to be "
            f"repeated, got {shown(sorted(unknown)[0])}; update fpsolve."
        )
    return arguments
