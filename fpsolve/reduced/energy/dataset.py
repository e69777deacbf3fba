"""A solution of the energy process as a labelled `xarray.Dataset`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fpsolve._support.labels import labels, origin, to_json
from fpsolve.evolution.saved import described_as
from fpsolve.model.potentials.dictionaries import potential_to_dict

if TYPE_CHECKING:
    import xarray as xr


__all__ = ["SERIES", "process_attributes", "to_xarray"]

SERIES = {
    "mass": "mass ∫ p dg",
    "relative_entropy": "relative entropy to the stationary law S/∫S",
    "entropy_dissipation": "entropy dissipation −dH/ds of the discrete equation",
    "minimum": "smallest cell mass",
    "saved_l1": "L¹ norm of p",
}


def to_xarray(solution: Any) -> xr.Dataset:
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
            variables[name] = ("s_step", values, labels(SERIES[name]))
    for name, values in (solution.errors or {}).items():
        dimension = "s" if name == "saved_l1" else "s_step"
        meaning = labels(f"estimated error in ds of: {SERIES[name]}")
        variables[f"{name}_error"] = (dimension, values, meaning)
    coordinates = {
        "s": ("s", solution.saved_s, labels("arclength s of the saved densities")),
        "s_step": ("s_step", solution.s, labels("arclength s of the recorded steps")),
        "g": ("g", grid.centres, labels("mean energy of the cell, stationary law")),
        "face": ("face", grid.faces, labels("ends of the cells")),
    }
    attributes = {
        "title": "law of the energy process of fibre lay-down",
        **process_attributes(solution.process, solution.provenance),
        **origin(solution.provenance),
        "n_cells": grid.n_cells,
        "signed": int(grid.signed),
        "method": solution.method,
        "ds": solution.ds,
        "status": solution.status,
    }
    return described_as(xr.Dataset(variables, coordinates, attributes), solution)


def process_attributes(process: Any, provenance: Any) -> dict[str, Any]:
    """Return the attributes that say which process it is.

    Of a process that could not be read back they go on as they came.
    """
    if process is None:
        return dict(provenance["process_description"])
    return {
        "equation": "dG = −(A²/2) G ds + σ(G) dW, σ² = A² J(G)/S(G)",
        "potential": to_json(potential_to_dict(process.potential)),
        "formula": process.potential.formula,
        "noise": process.noise,
        "radius": process.radius,
        "g_max": process.g_max,
    }
