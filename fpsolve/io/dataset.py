"""Results of every kind as labelled `xarray.Dataset`, and back."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from fpsolve.io import paths, solutions
from fpsolve.paths import Paths
from fpsolve.solution import Solution

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["FORMAT", "from_xarray", "to_xarray"]

# Number of these layouts; raised whenever an older version could misread a file.
FORMAT = 1
# An older file that does not say what it holds is a solution.
_READERS: dict[str, Callable[[xr.Dataset], Solution | Paths]] = {
    "solution": solutions.from_xarray,
    "paths": paths.from_xarray,
}


def to_xarray(result: Solution | Paths) -> xr.Dataset:
    """Return a solution, p(s, ξ1, ξ2, α) with its series, or paths as a dataset.

    The attribute `fpsolve_kind` says which: "solution" or "paths".

    Parameters
    ----------
    result : Solution or Paths
    """
    if isinstance(result, Paths):
        kind, dataset = "paths", paths.to_xarray(result)
    else:
        kind, dataset = "solution", solutions.to_xarray(result)
    return dataset.assign_attrs(fpsolve_kind=kind, fpsolve_format=FORMAT)


def from_xarray(dataset: xr.Dataset) -> Solution | Paths:
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
    written = dataset.attrs.get("fpsolve_format")
    if written is None:
        raise ValueError(
            "it is not a result of fpsolve (attribute `fpsolve_format` is missing)"
        )
    if int(written) > FORMAT:
        raise ValueError(
            f"it has layout {int(written)}, this version of fpsolve reads up to "
            f"{FORMAT}; update fpsolve"
        )
    kind = str(dataset.attrs.get("fpsolve_kind", "solution"))
    if kind not in _READERS:
        raise ValueError(
            f"it holds {kind!r}, this version of fpsolve reads "
            f"{' and '.join(map(repr, _READERS))}; update fpsolve"
        )
    return _READERS[kind](dataset)
