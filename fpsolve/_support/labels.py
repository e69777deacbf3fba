"""What the datasets of all kinds of results have in common."""

from __future__ import annotations

import json
import warnings
from collections.abc import Collection, Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.digests import SAMPLED
from fpsolve._support.environment import environment
from fpsolve._support.provenance import versions
from fpsolve.model.curves.dictionaries import KINDS as CURVE_KINDS
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.dictionaries import KINDS as POTENTIAL_KINDS

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "check_complete",
    "describe_model",
    "labels",
    "made_with",
    "origin",
    "read_model",
    "to_json",
]

# Entries of `provenance` that stand in for a model that cannot be read back.
_UNREADABLE = ("model_description", "equation")


def labels(name: str) -> dict[str, str]:
    """Return the attributes of a variable; every quantity is dimensionless."""
    return {"long_name": name, "units": "1"}


def to_json(value: Any) -> str:
    """Return the value as JSON, with the repr of what JSON cannot hold."""
    # A user's own potential may hold anything; its repr describes it best.
    return json.dumps(value, default=_plain, ensure_ascii=False)


def describe_model(
    model: LayDownModel | None, equation: str | None, provenance: Mapping[str, Any]
) -> dict[str, str]:
    """Return the attributes `equation` and `model`.

    Parameters
    ----------
    model : LayDownModel or None
        None if it was read from a file from which it could not be made again; its
        description goes on as it came.
    equation : str or None
        What was solved, with parameters; None without a model.
    provenance : mapping
    """
    if model is None:
        description, equation = (provenance.get(key, "") for key in _UNREADABLE)
    else:
        description = to_json(model.to_dict())
    return {"equation": equation or "", "model": description}


def made_with() -> dict[str, str]:
    """Return the attributes `versions` and `environment` of what is made now."""
    return {"versions": to_json(versions()), "environment": to_json(environment())}


def origin(provenance: Mapping[str, Any]) -> dict[str, Any]:
    """Return the attributes that tell what made the result, and `provenance` whole.

    Versions and date are seen by a reader of the file without parsing.
    """
    own = {key: entry for key, entry in provenance.items() if key not in _UNREADABLE}
    versions = own.get("versions", {})
    flat = {f"{package}_version": number for package, number in versions.items()}
    if "date" in own:
        flat["date_created"] = own["date"]
    return {**flat, "provenance": to_json(own)}


def check_complete(
    dataset: xr.Dataset, variables: Iterable[str], attributes: Iterable[str]
) -> None:
    """Raise ValueError if a variable or an attribute is missing."""
    missing = [f"`{name}`" for name in variables if name not in dataset]
    missing += [f"`{name}`" for name in attributes if name not in dataset.attrs]
    if missing:
        raise ValueError(f"{', '.join(missing)} is missing in it")


def read_model(
    attributes: Mapping[str, Any], provenance: dict[str, Any]
) -> LayDownModel | None:
    """Return the model, or None with a warning if it was made of a user's functions.

    Its description and equation are added to the provenance then.

    Parameters
    ----------
    attributes : mapping
        As `fpsolve.io.declared.declared` returns them.
    provenance : dict
    """
    description = attributes["model"]
    try:
        return LayDownModel.from_dict(description)
    except ValueError as error:
        if not _of_a_user(description):
            raise
        provenance["model_description"] = to_json(description)
        provenance["equation"] = attributes["equation"]
        warnings.warn(
            f"the model could not be read back, so `model` is None: {error}",
            UserWarning,
            stacklevel=5,
        )
        return None


def _of_a_user(description: Mapping[str, Any]) -> bool:
    """Whether the potential or the curve is of a class that fpsolve has not."""
    known: dict[str, Collection[str]] = {
        "potential": POTENTIAL_KINDS,
        "curve": CURVE_KINDS,
    }
    parts = {name: description.get(name) for name in known}
    return any(
        isinstance(part, Mapping)
        and isinstance(part.get("kind"), str)
        and (part["kind"] not in known[name] or SAMPLED in part)
        for name, part in parts.items()
    )


def _plain(value: Any) -> Any:
    if isinstance(value, np.generic):
        return value.item()
    return value.tolist() if isinstance(value, np.ndarray) else repr(value)
