"""A model as attributes of a file, and back, also one of a user's own functions."""

from __future__ import annotations

import warnings
from collections.abc import Collection, Mapping
from typing import Any

from fpsolve._support.digests import SAMPLED
from fpsolve._support.labels import UNREADABLE, to_json
from fpsolve.model.curves.dictionaries import KINDS as CURVE_KINDS
from fpsolve.model.fibre import FibreModel
from fpsolve.model.potentials.dictionaries import KINDS as POTENTIAL_KINDS
from fpsolve.model.reading import model_from_dict

__all__ = ["describe_model", "is_of_a_user", "read_model"]

_KNOWN: dict[str, Collection[str]] = {
    "potential": POTENTIAL_KINDS,
    "curve": CURVE_KINDS,
}


def describe_model(
    model: FibreModel | None, equation: str | None, provenance: Mapping[str, Any]
) -> dict[str, str]:
    """Return the attributes `equation` and `model`.

    Parameters
    ----------
    model : FibreModel or None
        None if it was read from a file from which it could not be made again; its
        description goes on as it came.
    equation : str or None
        What was solved, with parameters; None without a model.
    provenance : mapping
    """
    if model is None:
        description, equation = (provenance.get(key, "") for key in UNREADABLE[:2])
    else:
        description = to_json(model.to_dict())
    return {"equation": equation or "", "model": description}


def read_model(attributes: Mapping[str, Any], provenance: dict[str, Any]) -> Any:
    """Return the model, or None with a warning if it was made of a user's functions.

    Its description and equation are added to the provenance then.

    Parameters
    ----------
    attributes : mapping
        As `fpsolve._support.declared.declared` returns them.
    provenance : dict
    """
    description = attributes["model"]
    try:
        return model_from_dict(description)
    except ValueError as error:
        if not _of_a_user(description):
            raise
        provenance["model_description"] = to_json(description)
        provenance["equation"] = attributes["equation"]
        warnings.warn(
            f"the model could not be read back, so `model` is None: {error}",
            UserWarning,
            stacklevel=7,
        )
        return None


def _of_a_user(description: Mapping[str, Any]) -> bool:
    """Whether the potential or the curve is of a class that fpsolve has not."""
    return any(is_of_a_user(name, description.get(name)) for name in _KNOWN)


def is_of_a_user(name: str, part: Any) -> bool:
    """Whether a "potential" or a "curve" is described as one that fpsolve has not."""
    return (
        isinstance(part, Mapping)
        and isinstance(part.get("kind"), str)
        and (part["kind"] not in _KNOWN[name] or SAMPLED in part)
    )
