"""A solution of the energy process from the dataset that describes it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fpsolve._support.declared import declared
from fpsolve._support.labels import check_complete
from fpsolve.evolution.layout import check_counts, check_dimensions, check_run
from fpsolve.evolution.series import read_errors
from fpsolve.model.potentials.dictionaries import potential_from_dict
from fpsolve.reduced.energy.dataset import SERIES
from fpsolve.reduced.energy.process import EnergyProcess
from fpsolve.reduced.energy.solution import EnergySolution

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["from_xarray"]

_NEEDED = ("s", "s_step", "cell_mass")
_NEEDED_ATTRIBUTES = (
    "potential", "noise", "n_cells", "signed", "method", "ds", "status", "provenance",
)  # fmt: skip
_DIMENSIONS = {"s": ("s",), "s_step": ("s_step",), "cell_mass": ("s", "g")}


def from_xarray(dataset: xr.Dataset) -> EnergySolution:
    """Return the solution that `to_xarray` turned into `dataset`, bit for bit.

    Parameters
    ----------
    dataset : xarray.Dataset

    Raises
    ------
    ValueError
        If the dataset does not have the layout of `to_xarray`, or the potential was a
        user's own code, without which there are no cells.
    """
    check_complete(dataset, _NEEDED, _NEEDED_ATTRIBUTES)
    about = declared(dataset.attrs)
    check_counts("n_cells", about["n_cells"], dataset["cell_mass"].shape[-1],
                 "`cell_mass`")  # fmt: skip
    check_dimensions(dataset, _DIMENSIONS)
    check_run(dataset, about)
    potential = potential_from_dict(about["potential"])
    process = EnergyProcess(potential, float(about["noise"]))
    errors = read_errors(dataset)
    series = {name: dataset[name].values for name in SERIES if name in dataset}
    return EnergySolution(
        process=process,
        grid=process.grid(about["n_cells"], bool(about["signed"])),
        method=about["method"],
        ds=float(about["ds"]),
        series={"s": dataset["s_step"].values, **series},
        errors=errors or None,
        saved_s=dataset["s"].values,
        masses=dataset["cell_mass"].values,
        provenance=about["provenance"],
        initial_masses=(
            dataset["initial_mass"].values if "initial_mass" in dataset else None
        ),
        status=about["status"],
    )
