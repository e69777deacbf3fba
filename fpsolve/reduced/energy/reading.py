"""A solution of the energy process from the dataset that describes it."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from fpsolve._support.declared import declared
from fpsolve._support.labels import (
    UNREADABLE,
    check_complete,
    read_provenance,
    to_json,
)
from fpsolve.evolution.call import Call
from fpsolve.evolution.layout import check_counts, check_dimensions, check_run
from fpsolve.evolution.series import read_errors
from fpsolve.model.potentials.dictionaries import potential_from_dict
from fpsolve.model.stored import is_of_a_user
from fpsolve.reduced.energy.dataset import SERIES
from fpsolve.reduced.energy.grid import EnergyGrid
from fpsolve.reduced.energy.process import EnergyProcess
from fpsolve.reduced.energy.solution import EnergySolution

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["from_xarray", "read_process"]

_NEEDED = ("s", "s_step", "cell_mass", "g", "face", "stationary_mass")
_NEEDED_ATTRIBUTES = (
    "potential", "noise", "n_cells", "signed", "method", "ds", "status", "provenance",
)  # fmt: skip
_DIMENSIONS = {
    "s": ("s",), "s_step": ("s_step",), "cell_mass": ("s", "g"), "g": ("g",),
    "face": ("face",), "stationary_mass": ("g",),
}  # fmt: skip


def from_xarray(dataset: xr.Dataset) -> EnergySolution:
    """Return the solution that `to_xarray` turned into `dataset`, bit for bit.

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
        If the potential was a user's own code; `process` is None then.
    """
    check_complete(dataset, _NEEDED, _NEEDED_ATTRIBUTES)
    about = declared(dataset.attrs)
    check_counts("n_cells", about["n_cells"], dataset["cell_mass"].shape[-1],
                 "`cell_mass`")  # fmt: skip
    check_dimensions(dataset, _DIMENSIONS)
    check_run(dataset, about)
    provenance = read_provenance(about)
    process = read_process(about, provenance)
    errors = read_errors(dataset)
    series = {name: dataset[name].values for name in SERIES if name in dataset}
    return EnergySolution(
        process=process,
        grid=_read_grid(dataset, process, bool(about["signed"])),
        method=about["method"],
        ds=float(about["ds"]),
        series={"s": dataset["s_step"].values, **series},
        errors=errors or None,
        saved_s=dataset["s"].values,
        masses=dataset["cell_mass"].values,
        provenance=provenance,
        initial_masses=(
            dataset["initial_mass"].values if "initial_mass" in dataset else None
        ),
        status=about["status"],
        call=Call.from_xarray(dataset),
    )


def read_process(
    about: Mapping[str, Any], provenance: dict[str, Any]
) -> EnergyProcess | None:
    """Return the process, or None with a warning if its potential was a user's own.

    What described it is added to the provenance then.
    """
    try:
        potential = potential_from_dict(about["potential"])
    except ValueError as error:
        if not is_of_a_user("potential", about["potential"]):
            raise
        names = ("equation", "formula", "noise", "radius", "g_max")
        described = {name: about[name] for name in names if name in about}
        described["potential"] = to_json(about["potential"])
        provenance[UNREADABLE[2]] = described
        warnings.warn(
            f"the process could not be read back, so `process` is None: {error}",
            UserWarning,
            stacklevel=5,
        )
        return None
    return EnergyProcess(potential, float(about["noise"]))


def _read_grid(
    dataset: xr.Dataset, process: EnergyProcess | None, signed: bool
) -> EnergyGrid:
    """The cells; those of the file without the process that makes them."""
    if process is not None:
        return process.grid(dataset.sizes["g"], signed)
    faces, centres, masses = (dataset[name].values for name in
                              ("face", "g", "stationary_mass"))  # fmt: skip
    return EnergyGrid.of_cells(faces, centres, masses, signed)
