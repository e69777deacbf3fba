"""Paths of the hydrodynamic limit as a labelled `xarray.Dataset`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.labels import labels, origin
from fpsolve.evolution.saved import described_as
from fpsolve.model.stored import describe_model

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["to_xarray"]


def to_xarray(paths: Any) -> xr.Dataset:
    """ξ over (s, path, component), with means and covariances.

    Parameters
    ----------
    paths : HydrodynamicPaths
    """
    import xarray as xr

    model, both = paths.model, np.array([1, 2])
    (mean, mean_error), (spread, spread_error) = paths.mean(), paths.covariance()
    over = ("s", "component")
    pairs = (*over, "other")
    variables = {
        "xi": (("s", "path", "component"), paths.xi, labels("deviation ξ")),
        "mean": (over, mean, labels("mean E ξ")),
        "mean_standard_error": (over, mean_error, labels("its standard error")),
        "covariance": (pairs, spread, labels("covariance of ξ")),
        "covariance_standard_error": (pairs, spread_error, labels("standard error")),
    }
    coordinates = {
        "s": ("s", paths.s, labels("arclength s of the saved points")),
        "component": ("component", both, labels("1 along the belt, 2 across")),
        "other": ("other", both, labels("1 along the belt, 2 across")),
    }
    attributes = {
        "title": "Paths of the hydrodynamic limit of fibre lay-down",
        **describe_model(
            model, None if model is None else model.equation, paths.provenance
        ),
        "method": paths.method,
        "ds": paths.ds,
        **origin(paths.provenance),
    }
    return described_as(xr.Dataset(variables, coordinates, attributes), paths)
