"""Ends of a fibre as JSON holds them, and back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from fpsolve._support.checks import shown
from fpsolve.fibre.ends import Clamped, End, Free, Hinged, Nozzle

__all__ = ["end_from_dict", "end_to_dict"]

KINDS: dict[str, type[End]] = {
    "free": Free,
    "hinged": Hinged,
    "clamped": Clamped,
    "nozzle": Nozzle,
}


def end_to_dict(end: End) -> dict[str, Any]:
    """Its kind and its parameters."""
    (kind,) = (name for name, one in KINDS.items() if type(end) is one)
    return {"kind": kind, **{one.name: getattr(end, one.name) for one in fields(end)}}


def end_from_dict(about: Mapping[str, Any]) -> End:
    """The end; ValueError unless it is described as `end_to_dict` does."""
    parameters = dict(about)
    kind = parameters.pop("kind", None)
    if kind not in KINDS:
        raise ValueError(
            f"`kind` of an end must be one of {', '.join(KINDS)}, got {shown(kind)}."
        )
    made = KINDS[kind]
    known = {one.name for one in fields(made)}
    if parameters.keys() != known:
        raise ValueError(
            f"a {kind} end must have {', '.join(sorted(known)) or 'no parameters'}, "
            f"got {', '.join(sorted(parameters)) or 'none'}."
        )
    return made(**parameters)
