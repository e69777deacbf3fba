"""The energy process as labelled `xarray.Dataset`: a solution and back; tables."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.checks import check_integer
from fpsolve._support.declared import declared
from fpsolve._support.labels import check_complete, labels, made_with, origin, to_json
from fpsolve.density.layout import check_counts, check_dimensions, check_run
from fpsolve.evolution.series import read_errors
from fpsolve.model.potentials import potential_from_dict, potential_to_dict
from fpsolve.studies.recipe import recipe

if TYPE_CHECKING:
    import xarray as xr

    from fpsolve.reduced.energy import EnergyProcess, EnergySolution

__all__ = ["from_xarray", "tables_dataset", "to_xarray"]

_SERIES = {
    "mass": "mass ∫ p dg",
    "relative_entropy": "relative entropy to the stationary law S/∫S",
    "entropy_dissipation": "entropy dissipation −dH/ds of the discrete equation",
    "minimum": "smallest cell mass",
    "saved_l1": "L¹ norm of p",
}
_TABLES = {
    "r_min": "smallest distance r on the orbit",
    "r_max": "largest distance r on the orbit",
    "period": "period S(g)",
    "action": "action J(g), J′ = −g S",
    "variance": "variance σ²(g) = A² J/S per unit of s",
    "drift": "drift −A²g/2 per unit of s",
    "stationary_density": "stationary density S/∫S of |G|",
}
_NEEDED = ("s", "s_step", "cell_mass")
_NEEDED_ATTRIBUTES = (
    "potential", "noise", "n_cells", "signed", "method", "ds", "status", "provenance",
)  # fmt: skip
_DIMENSIONS = {"s": ("s",), "s_step": ("s_step",), "cell_mass": ("s", "g")}
_FAMILIES = ("even", "odd")


def to_xarray(solution: EnergySolution) -> xr.Dataset:
    """Densities (s, g), series over s_step, and their estimated errors.

    Parameters
    ----------
    solution : EnergySolution

    Returns
    -------
    xarray.Dataset
        `g` are the centres of the cells (stationary means), `face` their ends.
    """
    import xarray as xr

    grid = solution.grid
    variables: dict[str, Any] = {
        "density": (("s", "g"), solution.densities, labels("cell means of p(g, s)")),
        "cell_mass": (("s", "g"), solution.masses, labels("masses of the cells")),
        "stationary_mass": ("g", grid.equilibrium, labels("stationary cell masses")),
    }
    if solution.initial_masses is not None:
        meaning = labels("masses of the cells at the start, as given")
        variables["initial_mass"] = ("g", solution.initial_masses, meaning)
    for name, values in solution.series.items():
        if name != "s":
            variables[name] = ("s_step", values, labels(_SERIES[name]))
    for name, values in (solution.errors or {}).items():
        dimension = "s" if name == "saved_l1" else "s_step"
        meaning = labels(f"estimated error in ds of: {_SERIES[name]}")
        variables[f"{name}_error"] = (dimension, values, meaning)
    coordinates = {
        "s": ("s", solution.saved_s, labels("arclength s of the saved densities")),
        "s_step": ("s_step", solution.s, labels("arclength s of the recorded steps")),
        "g": ("g", grid.centres, labels("mean energy of the cell, stationary law")),
        "face": ("face", grid.faces, labels("ends of the cells")),
    }
    attributes = {
        "title": "law of the energy process of fibre lay-down",
        **_attributes(solution.process),
        **origin(solution.provenance),
        "n_cells": grid.n_cells,
        "signed": int(grid.signed),
        "method": solution.method,
        "ds": solution.ds,
        "status": solution.status,
    }
    return xr.Dataset(variables, coordinates, attributes)


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
    from fpsolve.reduced.energy import EnergyProcess, EnergySolution

    check_complete(dataset, _NEEDED, _NEEDED_ATTRIBUTES)
    about = declared(dataset.attrs)
    check_counts("n_cells", about["n_cells"], dataset["cell_mass"].shape[-1],
                 "`cell_mass`")  # fmt: skip
    check_dimensions(dataset, _DIMENSIONS)
    check_run(dataset, about)
    potential = potential_from_dict(about["potential"])
    process = EnergyProcess(potential, float(about["noise"]))
    errors = read_errors(dataset)
    series = {name: dataset[name].values for name in _SERIES if name in dataset}
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


def tables_dataset(
    process: EnergyProcess, n_energies: int, n_eigenvalues: int
) -> xr.Dataset:
    """Coefficients over g in (0, g_max], and the eigenvalues of both families.

    Parameters
    ----------
    process : EnergyProcess
    n_energies : int
        Energies g_max k/n, k = 1, ..., n; at g = 0 the period is infinite.
    n_eigenvalues : int
        Of each family.

    Returns
    -------
    xarray.Dataset
    """
    import xarray as xr

    n_energies = check_integer("n_energies", n_energies, at_least=1)
    g = process.g_max * np.arange(1, n_energies + 1) / n_energies
    r_min, r_max = process.turning_points(g)
    tables = {"r_min": r_min, "r_max": r_max} | {
        name: getattr(process, name)(g) for name in _TABLES if name[:2] != "r_"
    }
    spectra = [process.spectrum(n_eigenvalues, family) for family in _FAMILIES]
    variables: dict[str, Any] = {
        name: ("g", values, labels(_TABLES[name])) for name, values in tables.items()
    }
    rates = np.array([found.eigenvalues for found in spectra])
    errors = np.array([found.errors for found in spectra])
    where = ("family", "mode")
    variables["eigenvalue"] = (where, rates, labels("decay rate of (16)"))
    variables["eigenvalue_error"] = (where, errors, labels("error of the decay rate"))
    coordinates = {
        "g": ("g", g, labels("energy G = r exp(−B(r)) sin β")),
        "family": ("family", np.array(_FAMILIES, dtype=object)),
        "mode": ("mode", np.arange(n_eigenvalues)),
    }
    attributes = {
        "title": "energy process of fibre lay-down",
        **_attributes(process),
        **recipe("energy_tables", {
            "potential": process.potential, "noise": process.noise,
            "n_energies": n_energies, "n_eigenvalues": n_eigenvalues,
        }),
    }  # fmt: skip
    return xr.Dataset(variables, coordinates, attributes)


def _attributes(process: EnergyProcess) -> dict[str, Any]:
    return {
        "equation": "dG = −(A²/2) G ds + σ(G) dW, σ² = A² J(G)/S(G)",
        "potential": to_json(potential_to_dict(process.potential)),
        "formula": process.potential.formula,
        "noise": process.noise,
        "radius": process.radius,
        "g_max": process.g_max,
        **made_with(),
    }
