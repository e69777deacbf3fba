"""Results of every kind as labelled `xarray.Dataset`, and back."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from fpsolve._support.declared import declared
from fpsolve.density.solution import Solution
from fpsolve.paths import Paths

if TYPE_CHECKING:
    import xarray as xr

    from fpsolve.reduced.energy import EnergySolution
    from fpsolve.reduced.hydrodynamic import HydrodynamicSolution

    Result = Solution | Paths | HydrodynamicSolution | EnergySolution

__all__ = ["FORMAT", "from_xarray", "kind_of", "marked", "to_xarray"]

# Number of these layouts; raised whenever an older version could misread a file.
FORMAT = 1
# What files hold, and the module of fpsolve.io that reads and writes it. An older file
# that does not say what it holds is a solution.
_MODULES = {
    "solution": "solutions",
    "paths": "paths",
    "hydrodynamic": "hydrodynamic",
    "energy": "energy",
}


def to_xarray(result: Result) -> xr.Dataset:
    """Return a solution, p(s, ξ1, ξ2, α) with its series, or paths as a dataset.

    The attribute `fpsolve_kind` says which: "solution" or "paths", or "hydrodynamic"
    or "energy" for a solution of a limit.

    Parameters
    ----------
    result : Solution, Paths, HydrodynamicSolution or EnergySolution

    Raises
    ------
    TypeError
        If it is something else.
    """
    kind = kind_of(result)
    dataset: xr.Dataset = _module(kind).to_xarray(result)
    return marked(dataset, kind)


def kind_of(result: Any) -> str:
    """Return what a file of the result would say that it holds."""
    if isinstance(result, Solution):
        return "solution"
    if isinstance(result, Paths):
        return "paths"
    # The limits are not imported for the others.
    from fpsolve.reduced.energy import EnergySolution
    from fpsolve.reduced.hydrodynamic import HydrodynamicSolution

    if isinstance(result, HydrodynamicSolution):
        return "hydrodynamic"
    if isinstance(result, EnergySolution):
        return "energy"
    raise TypeError(
        "`result` must be a Solution, Paths, a HydrodynamicSolution or an "
        f"EnergySolution, got {type(result).__name__}."
    )


def _module(kind: str) -> Any:
    return importlib.import_module(f"fpsolve.results.{_MODULES[kind]}")


def marked(dataset: xr.Dataset, kind: str) -> xr.Dataset:
    """Return the dataset with the attributes that say what it holds."""
    return dataset.assign_attrs(fpsolve_kind=kind, fpsolve_format=FORMAT)


def from_xarray(dataset: xr.Dataset) -> Result:
    """Return the result that `to_xarray` turned into `dataset`.

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
    about = declared(dataset.attrs)
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
    kind = about.get("fpsolve_kind", "solution")
    if kind not in _MODULES:
        known = ", ".join(map(repr, _MODULES))
        raise ValueError(
            f"it holds {kind!r}, this version of fpsolve reads {known}; update fpsolve"
        )
    found: Result = _module(kind).from_xarray(dataset)
    return found
