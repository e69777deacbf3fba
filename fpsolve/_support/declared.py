"""The attributes of files: of which type each is, read and checked in one place.

What comes from a file may be anything. Whoever needs an attribute takes it from
`declared`, where it has the type that is written here, or from none.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np

from fpsolve._support.checks import shown
from fpsolve._support.json_text import bounded_json

if TYPE_CHECKING:
    from pydantic import TypeAdapter

__all__ = ["OWN", "declared", "is_own"]

_TEXTS = (
    "Conventions", "title", "equation", "status", "message", "date_created", "date",
    "fpsolve_kind", "seed", "method", "verdict", "formula", "command", "configuration",
    "positions", "cost",
)  # fmt: skip
_NUMBERS = (
    "ds", "s_start", "false_alarm", "gap", "gap_error", "essential", "noise", "radius",
    "g_max", "slow_length", "belt_speed_scale", "fixed_speed", "expected_order",
    "tolerance", "s_end", "belt_speed", "titer", "period", "bending",
    "pixel",
)  # fmt: skip
_INTEGERS = (
    "n_paths", "n_steps", "n_cells", "kept", "agrees", "quick", "signed",
    "fpsolve_format", "n_energies", "extrapolated", "n_webs",
    "newest",
)  # fmt: skip
# JSON: objects, and what is known of their entries.
_TABLES = (
    "model", "grid", "scheme", "initial", "potential", "p0", "settings", "options",
    "solver", "sampler", "versions", "environment", "provenance", "call",
    "fpsolve_checksums", "process", "web", "curve",
    "undetermined", "string", "belt", "models",
)  # fmt: skip
_LISTS = (
    "saved_steps", "truncation", "sectors", "fpsolve_attributes", "nozzle_phases",
    "notes",
)  # fmt: skip
OWN = frozenset((*_TEXTS, *_NUMBERS, *_INTEGERS, *_TABLES, *_LISTS))


def is_own(name: str) -> bool:
    """Whether fpsolve writes an attribute of that name."""
    return name in OWN or name.endswith("_version")


def declared(attributes: Mapping[Any, Any]) -> dict[str, Any]:
    """Return the attributes that fpsolve writes, JSON read, each of its type.

    Others are left out: they are of other programs.

    Parameters
    ----------
    attributes : mapping
        Those of a dataset, from a file or not.

    Raises
    ------
    ValueError
        If one is of another type, its JSON is none, or nested too deeply.
    """
    read = {
        str(name): _read(str(name), value)
        for name, value in attributes.items()
        if is_own(str(name))
    }
    # Of a check against a density without a model.
    if read.get("model") == "":
        del read["model"]
    _validate(read)
    return read


def _read(name: str, value: Any) -> Any:
    if name in _TABLES or name in _LISTS:
        return value if value == "" and name == "model" else bounded_json(name, value)
    # Files of every kind give numbers of numpy, some as arrays of one.
    if isinstance(value, np.generic | np.ndarray) and np.size(value) == 1:
        value = value.item()
    if isinstance(value, bool) and name in _INTEGERS:
        return int(value)
    return value


def _validate(read: dict[str, Any]) -> None:
    from pydantic import ValidationError

    try:
        _types().validate_python(read, strict=True)
    except ValidationError as error:
        first = error.errors(include_url=False, include_context=False)[0]
        place = ".".join(map(str, first["loc"]))
        rule = _RULES.get(first["type"], first["msg"].replace("Input should ", "must "))
        raise ValueError(f"`{place}` {rule}, got {shown(first['input'])}.") from None


_RULES = {
    "dict_type": "must be a table",
    "list_type": "must be a list",
    "string_type": "must be text",
    "float_type": "must be a number",
    "int_type": "must be an integer",
    "int_from_float": "must be an integer",
    "bool_type": "must be true or false",
    "missing": "must be given",
}


# Types made at run time, of which mypy knows nothing.
_TABLE: Any = dict[str, Any]
_TEXTS_BY_NAME: Any = dict[str, str]


@cache
def _types() -> TypeAdapter[Any]:
    """Types of all attributes."""
    from pydantic import TypeAdapter

    count, counts = _count(), list[_count()]  # type: ignore[misc]
    start = _entries("Start", {"kind": str})
    return TypeAdapter(_entries("Attributes", {
        **dict.fromkeys(_TEXTS, str), **dict.fromkeys(_NUMBERS, float),
        **dict.fromkeys(_INTEGERS, count), **dict.fromkeys(_TABLES, _TABLE),
        "saved_steps": counts, "truncation": counts, "fpsolve_attributes": list[str],
        "notes": list[str], "undetermined": _TEXTS_BY_NAME,
        "model": _entries("Model", {"potential": _TABLE, "curve": _TABLE}),
        "scheme": _entries("Scheme", {"name": str, "order": int, "options": _TABLE}),
        "initial": start, "p0": start, "versions": _TEXTS_BY_NAME,
        "environment": _environment_type(), "provenance": _provenance_type(),
        "call": _entries("Call", {"function": str, "arguments": _TABLE}),
        "fpsolve_checksums": _TEXTS_BY_NAME,
        "web": _entries("Web", {
            "window": dict[str, float], "reach": list[list[float]], "n_burn": count,
            "remainder": float, "relaxation": float, "periodic": bool, "origin": float,
            "spacing": float, "speed": float,
        }),
    }))  # fmt: skip


def _provenance_type() -> Any:
    """Type of what `provenance` holds, as far as it is read."""
    return _entries("Provenance", {
        "versions": _TEXTS_BY_NAME, "environment": _environment_type(), "date": str,
        "wall_seconds": float, "cpu_seconds": float, "n_steps": _count(),
        "extrapolated": bool, "levels": _count(), "configuration": str,
        "suggested": _TEXTS_BY_NAME,
        "initial_description": _TABLE, "model_description": str, "equation": str,
    })  # fmt: skip


def _environment_type() -> Any:
    numba = _entries("Numba", {"threads": int})
    packages = {"packages": _TEXTS_BY_NAME, "blas": list[_TABLE], "numba": numba}
    return _entries("Environment", packages)


def _count() -> Any:
    """Type of integers that arrays can have."""
    from pydantic import Field

    return Annotated[int, Field(ge=-(2**63), lt=2**63)]


def _entries(name: str, types: dict[str, Any]) -> Any:
    """Type of a table, of which some entries are known."""
    from pydantic import ConfigDict
    from typing_extensions import TypedDict

    make: Any = TypedDict
    made = make(name, types, total=False)
    made.__pydantic_config__ = ConfigDict(extra="allow")
    return made
