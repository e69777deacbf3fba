"""Parts of a model as dictionaries, and back: potentials and curves."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from fpsolve._support.checks import construct
from fpsolve._support.digests import SAMPLED, plain

__all__ = ["described", "rebuilt"]

Part = TypeVar("Part")


def described(
    part: Any, known: Mapping[str, type], digest: Callable[[Any], str]
) -> dict[str, Any]:
    """Return a description that two parts share only if they do the same.

    Parameters
    ----------
    part : Potential or Curve
    known : mapping of str to type
        Classes of fpsolve by their kinds, whose `to_dict` says everything.
    digest : callable
        Of what a part of another class computes, which is added to its description.
    """
    if type(part) in known.values():
        return dict(part.to_dict())
    try:
        description = plain(part.to_dict())
    # It is no dataclass.
    except TypeError:
        description = plain({"kind": part.kind, "description": repr(part)})
    return {**description, SAMPLED: digest(part)}


def rebuilt(
    name: str, description: Mapping[str, Any], known: Mapping[str, type[Part]]
) -> Part:
    """Return the part that was `described`; ValueError for one of another class."""
    parameters = dict(description)
    kind = parameters.pop("kind", None)
    if SAMPLED in parameters:
        raise ValueError(
            f"`{name}` must not be of your own code to be read back, got {kind!r}; "
            "build it again in Python."
        )
    if not (isinstance(kind, str) and kind in known):
        kinds = ", ".join(map(repr, known))
        raise ValueError(f"`kind` of a {name} must be one of {kinds}, got {kind!r}.")
    return construct(known[kind], kind, parameters)
