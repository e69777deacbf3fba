"""Paths of the energy process as a labelled `xarray.Dataset`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fpsolve._support.labels import labels, origin
from fpsolve.evolution.saved import described_as
from fpsolve.reduced.energy.dataset import process_attributes

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["to_xarray"]


def to_xarray(paths: Any) -> xr.Dataset:
    """Signed energies over (s, path).

    Parameters
    ----------
    paths : EnergyPaths
    """
    import xarray as xr

    variables = {"energy": (("s", "path"), paths.g, labels("signed energy G"))}
    attributes = {
        "title": "Paths of the energy process of fibre lay-down",
        **process_attributes(paths.process, paths.provenance),
        **origin(paths.provenance),
        "ds": paths.ds,
        # As text, because a seed may be longer than any integer of a file.
        "seed": str(paths.seed),
        "method": paths.method,
    }
    coordinates = {"s": ("s", paths.s, labels("arclength s of the saved points"))}
    return described_as(xr.Dataset(variables, coordinates, attributes), paths)
