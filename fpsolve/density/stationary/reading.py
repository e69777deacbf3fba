"""A stationary density from the dataset that describes it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fpsolve._support.declared import declared
from fpsolve._support.labels import check_complete, read_provenance
from fpsolve.density.stationary.result import SteadyState
from fpsolve.evolution.call import Call
from fpsolve.evolution.layout import check_counts, check_dimensions, check_step
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.row_sums import MOMENTS
from fpsolve.model.stored import read_model

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["from_xarray"]

_NEEDED = ("density", "density_l1_error", "part_error", "part", "splitting",
           "quantity", "residual", "n_applications")  # fmt: skip
_NEEDED_ATTRIBUTES = ("model", "grid", "ds", "extrapolated", "provenance")
_AXES = ("xi1", "xi2", "alpha")


def from_xarray(dataset: xr.Dataset) -> SteadyState:
    """Return the stationary density that `to_xarray` turned into `dataset`.

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
        If the model was made of a user's own functions; `model` is None then.
    """
    check_complete(dataset, _NEEDED, _NEEDED_ATTRIBUTES)
    about = declared(dataset.attrs)
    provenance = read_provenance(about)
    grid = PhaseSpaceGrid.from_dict(about["grid"])
    check_dimensions(
        dataset,
        {"density": _AXES, "part_error": ("part",), "splitting": ("quantity",),
         "density_l1_error": (), "residual": (), "n_applications": ()},
    )  # fmt: skip
    check_counts("grid", grid.shape, dataset["density"].shape, "`density`")
    check_step(about["ds"])
    known = [name for name in MOMENTS if f"{name}_error" in dataset]
    return SteadyState(
        density=dataset["density"].values,
        residual=float(dataset["residual"]),
        grid=grid,
        ds=float(about["ds"]),
        n_applications=int(dataset["n_applications"]),
        error=float(dataset["density_l1_error"]),
        errors=_table(dataset, "part", "part_error"),
        moment_errors={name: float(dataset[f"{name}_error"]) for name in known},
        splitting=_table(dataset, "quantity", "splitting"),
        extrapolated=bool(about["extrapolated"]),
        model=read_model(about, provenance),
        call=Call.from_xarray(dataset),
        provenance=provenance,
    )


def _table(dataset: xr.Dataset, names: str, values: str) -> dict[str, float]:
    pairs = zip(dataset[names].values, dataset[values].values, strict=True)
    return {str(name): float(value) for name, value in pairs}
