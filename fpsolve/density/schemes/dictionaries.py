"""Schemes as dictionaries, and back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fpsolve.density.schemes.known import SCHEMES
from fpsolve.density.schemes.scheme import Scheme
from fpsolve.grids.smooth import AnyGrid
from fpsolve.model.fibre import FibreModel
from fpsolve.model.identity.digests import digest_or_none

__all__ = ["CODE", "describe_scheme", "described_scheme", "scheme_from_dict"]

# Key of what tells a class of a user's own from others: its name and a digest.
CODE = "code"
# That of the number of a scheme's arithmetic, of schemes in which it has changed.
REVISION = "revision"


def describe_scheme(scheme: Scheme) -> dict[str, Any]:
    """Return name, order and options of a scheme, ready for JSON.

    Of a scheme that computes other numbers than it once did, the `revision` besides:
    what the older one began is not its to continue. Of a user's own class, which may
    have inherited a name, also which code it is.
    """
    kind = getattr(scheme, "described_as", type(scheme))
    about = {
        "name": scheme.name,
        "order": scheme.order,
        "options": dict(scheme.options),
    }
    revision = getattr(kind, REVISION, None)
    if revision is not None:
        about[REVISION] = revision
    if kind not in SCHEMES.values():
        digest = digest_or_none(kind, sampled=False)
        about[CODE] = f"{kind.__module__}.{kind.__qualname__} {digest}"
    return about


def described_scheme(scheme: Any, arguments: Any = None) -> Any:
    """Return what a call says of a scheme; of a model in its place, the model."""
    if scheme is None or isinstance(scheme, FibreModel):
        return scheme
    about = describe_scheme(scheme)
    return {"$scheme": {"scheme": about, "model": scheme.model, "grid": scheme.grid}}


def scheme_from_dict(
    description: Mapping[str, Any], model: FibreModel, grid: AnyGrid
) -> Scheme:
    """Return the scheme that `describe_scheme` described.

    Raises
    ------
    ValueError
        If it is none of fpsolve.
    """
    name = description["name"]
    if CODE in description:
        own, _, _ = str(description[CODE]).rpartition(" ")
        raise ValueError(
            f"`scheme` must be one of fpsolve, got a class of your own that calls "
            f"itself {name!r} ({own})."
        )
    if name not in SCHEMES:
        known = ", ".join(repr(one) for one in SCHEMES)
        raise ValueError(f"`scheme` must be one of {known}, got {name!r}.")
    scheme: Scheme = SCHEMES[name](model, grid, **description["options"])
    return scheme
