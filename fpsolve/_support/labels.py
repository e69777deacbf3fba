"""What the datasets of all kinds of results have in common."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.environment import environment
from fpsolve._support.provenance import versions

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "FORMAT",
    "UNREADABLE",
    "check_complete",
    "labels",
    "made_with",
    "marked",
    "origin",
    "read_provenance",
    "to_json",
]


# Number of these layouts; raised whenever an older version could misread a file.
FORMAT = 1
# Entries of `provenance` that stand in for a model that cannot be read back.
UNREADABLE = ("model_description", "equation", "process_description")


def marked(dataset: xr.Dataset, kind: str) -> xr.Dataset:
    """Return the dataset with the attributes that say what it holds."""
    return dataset.assign_attrs(fpsolve_kind=kind, fpsolve_format=FORMAT)


def labels(name: str) -> dict[str, str]:
    """Return the attributes of a variable; every quantity is dimensionless."""
    return {"long_name": name, "units": "1"}


def to_json(value: Any) -> str:
    """Return the value as JSON, with the repr of what JSON cannot hold."""
    # A user's own potential may hold anything; its repr describes it best.
    return json.dumps(value, default=_plain, ensure_ascii=False)


def made_with() -> dict[str, str]:
    """Return the attributes `versions` and `environment` of what is made now."""
    return {"versions": to_json(versions()), "environment": to_json(environment())}


def origin(provenance: Mapping[str, Any]) -> dict[str, Any]:
    """Return the attributes that tell what made the result, and `provenance` whole.

    Versions and date are seen by a reader of the file without parsing.
    """
    own = {key: entry for key, entry in provenance.items() if key not in UNREADABLE}
    versions = own.get("versions", {})
    flat = {f"{package}_version": number for package, number in versions.items()}
    if "date" in own:
        flat["date_created"] = own["date"]
    if "command" in own:
        flat["command"] = own.pop("command")
    return {**flat, "provenance": to_json(own)}


def read_provenance(about: Mapping[str, Any]) -> dict[str, Any]:
    """Return the provenance of a result from the attributes that `origin` wrote."""
    command = {"command": about["command"]} if "command" in about else {}
    return {**about["provenance"], **command}


def check_complete(dataset: xr.Dataset, *names: str) -> None:
    """Raise ValueError if a variable or an attribute is missing."""
    there = {*dataset.variables, *dataset.attrs}
    missing = [f"`{name}`" for name in names if name not in there]
    if missing:
        raise ValueError(f"{', '.join(missing)} is missing in it")


def _plain(value: Any) -> Any:
    if isinstance(value, np.generic):
        return value.item()
    return value.tolist() if isinstance(value, np.ndarray) else repr(value)
