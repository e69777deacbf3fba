"""What two results were made with: parameters and environment that differ."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from fpsolve._support.declared import declared
from fpsolve.evolution.differences import differences

__all__ = ["differing_environment", "differing_parameters"]

# Attributes that say how a result came about are no parameters.
_ORIGIN = {
    "provenance", "versions", "environment", "date_created", "command", "configuration",
    "Conventions", "title", "equation", "formula", "verdict", "agrees", "message",
    "radius", "g_max", "gap", "gap_error", "essential", "truncation", "expected_order",
    "fpsolve_format", "fpsolve_checksums", "fpsolve_attributes",
}  # fmt: skip
_NONE = "not given"
_LONGEST = 60


def differing_parameters(a: Mapping[str, Any], b: Mapping[str, Any]) -> tuple[str, ...]:
    """Name every parameter in which the attributes of two results differ."""
    return tuple(_lines(_parameters(a), _parameters(b)))


def differing_environment(
    a: Mapping[str, Any], b: Mapping[str, Any]
) -> tuple[str, ...]:
    """Name the versions, and what is known of the machines, where they differ."""
    first, second = _environment(a), _environment(b)
    if not (first and second):
        return ()
    return tuple(_lines(first, second))


def _parameters(attributes: Mapping[str, Any]) -> dict[str, Any]:
    about = {**attributes, **declared(attributes)}
    asked = about.pop("call", {}).get("arguments", {}).items()
    parameters = {
        str(name): value
        for name, value in about.items()
        if name not in _ORIGIN and not name.endswith("_version")
    }
    # What is an attribute of its own need not be named twice.
    own = {key: one for key, one in asked if key not in attributes}
    return {**parameters, "call": own}


def _environment(attributes: Mapping[str, Any]) -> dict[str, Any]:
    """Versions and environment of a result, wherever it keeps them."""
    about = declared(attributes)
    origin = {**about.get("provenance", {}), **about}
    versions = origin.get("versions", {})
    environment = dict(origin.get("environment", {}))
    # Which BLAS is loaded depends on what else the process did.
    blas = environment.pop("blas", [])
    threads = sorted({str(one.get("threads")) for one in blas})
    libraries = sorted({f"{one.get('library')} {one.get('version')}" for one in blas})
    packages = {**environment.pop("packages", {}), **versions}
    packages.pop("python", None)
    numba = environment.pop("numba", {})
    flat = {**packages, **environment, **{f"numba.{k}": v for k, v in numba.items()}}
    if blas:
        flat["BLAS"] = ", ".join(libraries)
        flat["BLAS threads"] = ", ".join(threads)
    return flat


def _lines(a: Mapping[str, Any], b: Mapping[str, Any]) -> Iterator[str]:
    for name, one, other in differences(a, b):
        first, second = _shown(one), _shown(other)
        # Two NaN differ only as numbers.
        if first != second:
            yield f"{name}: {_cut(first)} in A, {_cut(second)} in B"


def _shown(value: Any) -> str:
    if value is None:
        return _NONE
    return repr(float(value)) if isinstance(value, float) else str(value)


def _cut(text: str) -> str:
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 2]} …"
