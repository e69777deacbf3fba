"""Expansions, in time and stationary, from the datasets that describe them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.declared import declared
from fpsolve._support.labels import check_complete, read_provenance
from fpsolve.evolution.call import Call
from fpsolve.evolution.layout import check_counts, check_dimensions, check_increasing
from fpsolve.grids.row_sums import MOMENTS
from fpsolve.model.laydown import LayDownModel
from fpsolve.spectral.evolution.evolution import SERIES
from fpsolve.spectral.evolution.expansion import Expansion
from fpsolve.spectral.evolution.solution import SpectralSolution
from fpsolve.spectral.evolution.steady import SpectralSteadyState

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["solution_from_xarray", "steady_from_xarray"]

_HELD = ("degree", "harmonics", "n_limits", "limit", "coefficient")
_ATTRIBUTES = ("model", "provenance")
# More than memory holds.
_LARGEST = 2000


def solution_from_xarray(dataset: xr.Dataset) -> SpectralSolution:
    """Return the expansion in time that `to_xarray` turned into `dataset`.

    Parameters
    ----------
    dataset : xarray.Dataset

    Raises
    ------
    ValueError
        If the dataset does not have the layout of `to_xarray`.
    """
    errors = [f"{name}_error" for name in SERIES]
    check_complete(
        dataset, ("s", *SERIES, *errors, *_HELD), (*_ATTRIBUTES, "tolerance")
    )
    check_dimensions(dataset, dict.fromkeys((*SERIES, *errors, *_HELD[:3]), ("s",)))
    check_increasing("s", dataset["s"].values)
    about = declared(dataset.attrs)
    return SpectralSolution(
        model=LayDownModel.from_dict(about["model"]),
        s=dataset["s"].values,
        series={name: dataset[name].values for name in SERIES},
        errors={name: dataset[f"{name}_error"].values for name in SERIES},
        truncation=_truncations(dataset),
        tolerance=float(about["tolerance"]),
        _expansions=_expansions(dataset),
        call=Call.from_xarray(dataset),
        provenance=read_provenance(about),
    )


def steady_from_xarray(dataset: xr.Dataset) -> SpectralSteadyState:
    """Return the stationary expansion that `to_xarray` turned into `dataset`.

    Parameters
    ----------
    dataset : xarray.Dataset

    Raises
    ------
    ValueError
        If the dataset does not have the layout of `to_xarray`.
    """
    errors = [f"{name}_error" for name in MOMENTS]
    check_complete(dataset, ("residual", *MOMENTS, *errors, *_HELD), _ATTRIBUTES)
    check_dimensions(dataset, dict.fromkeys(("residual", *MOMENTS, *errors), ()))
    check_counts("expansion", 2, dataset.sizes["expansion"], "`n_limits`")
    about = declared(dataset.attrs)
    fine, coarse = _expansions(dataset)
    return SpectralSteadyState(
        model=LayDownModel.from_dict(about["model"]),
        moments={name: float(dataset[name]) for name in MOMENTS},
        errors={name: float(dataset[f"{name}_error"]) for name in MOMENTS},
        residual=float(dataset["residual"]),
        truncation=_truncations(dataset)[0],
        _expansion=fine,
        _coarser=coarse,
        call=Call.from_xarray(dataset),
        provenance=read_provenance(about),
    )


def _truncations(dataset: xr.Dataset) -> tuple[tuple[int, int], ...]:
    degrees, harmonics = dataset["degree"].values, dataset["harmonics"].values
    return tuple(zip(map(int, degrees), map(int, harmonics), strict=True))


def _expansions(dataset: xr.Dataset) -> tuple[Expansion, ...]:
    """All expansions, each of as many coefficients as its limits say."""
    sizes, limits = dataset["n_limits"].values, dataset["limit"].values
    check_counts("n_limits", int(sizes.sum()), limits.size, "`limit`")
    if not (sizes.min(initial=1) > 0 and limits.max(initial=0) < _LARGEST):
        raise ValueError("`limit` must hold harmonics of every degree, got others")
    parts = np.split(limits, np.cumsum(sizes)[:-1])
    values: Any = dataset["coefficient"].values
    found = []
    for part in parts:
        count = Expansion.size(part)
        if count > values.size:
            raise ValueError("`coefficient` must fill the limits, got too few")
        found.append(Expansion.unpacked(part, values[:count]))
        values = values[count:]
    check_counts("coefficient", 0, values.size, "what is left of it")
    return tuple(found)
