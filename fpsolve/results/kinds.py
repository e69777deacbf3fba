"""The kinds of results: what each is called, and who reads it from a dataset."""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fpsolve._support.declared import declared
from fpsolve._support.labels import FORMAT

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["KINDS", "Kind", "from_xarray", "kind_of"]


@dataclass(frozen=True)
class Kind:
    """One kind of result that has a class of its own.

    Attributes
    ----------
    words : str
        In the plural, as messages call it.
    reading : str
        The module whose `from_xarray` makes the result from its dataset.
    """

    words: str
    reading: str


# What a result says in `kind`, and its file in `fpsolve_kind`.
KINDS = {
    "solution": Kind("solutions", "fpsolve.density.reading"),
    "paths": Kind("paths", "fpsolve.paths.reading"),
    "hydrodynamic": Kind(
        "solutions of the hydrodynamic limit", "fpsolve.reduced.hydrodynamic.reading"
    ),
    "energy": Kind("solutions of the energy process", "fpsolve.reduced.energy.reading"),
}


def kind_of(result: Any) -> str:
    """Return the key of `KINDS` for a result.

    Raises
    ------
    TypeError
        If it is something else.
    """
    kind = getattr(type(result), "kind", None)
    if not (isinstance(kind, str) and kind in KINDS):
        raise TypeError(
            "`result` must be a Solution, Paths, a HydrodynamicSolution or an "
            f"EnergySolution, got {type(result).__name__}."
        )
    return kind


def from_xarray(dataset: xr.Dataset) -> Any:
    """Return the result that its `to_xarray` turned into `dataset`.

    Arrays come back bit for bit. A model made of a user's own functions cannot be
    read back: `model` is None then, and its description and equation are in
    `provenance`.

    Parameters
    ----------
    dataset : xarray.Dataset

    Raises
    ------
    ValueError
        If the dataset does not have the layout of `to_xarray`.

    Warns
    -----
    UserWarning
        If the model could not be read back.
    """
    kind = _kind_of_dataset(declared(dataset.attrs))
    return importlib.import_module(KINDS[kind].reading).from_xarray(dataset)


def _kind_of_dataset(about: dict[str, Any]) -> str:
    written = about.get("fpsolve_format")
    if written is None:
        if "versions" in about:
            raise ValueError(
                f"it holds a study, {about.get('title', '')!r}, and no single result; "
                "`fpsolve report` and `compare` read it, and xarray opens it"
            )
        raise ValueError(
            "it is not a result of fpsolve (attribute `fpsolve_format` is missing)"
        )
    if written > FORMAT:
        raise ValueError(
            f"it has layout {written}, this version of fpsolve reads up to "
            f"{FORMAT}; update fpsolve"
        )
    kind: str = about.get("fpsolve_kind", "solution")
    if kind not in KINDS:
        known = ", ".join(map(repr, KINDS))
        raise ValueError(
            f"it holds {kind!r}, this version of fpsolve reads {known}; update fpsolve"
        )
    return kind
