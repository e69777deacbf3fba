"""Coefficients and eigenvalues of the energy process as a labelled dataset."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.checks import check_integer
from fpsolve._support.labels import labels, made_with, marked
from fpsolve.evolution.call import recorded
from fpsolve.model.potentials.potential import Potential
from fpsolve.reduced.energy.layout import process_attributes

if TYPE_CHECKING:
    import xarray as xr

    from fpsolve.reduced.energy.process import EnergyProcess

__all__ = ["energy_tables", "tables_dataset"]

_TABLES = {
    "r_min": "smallest distance r on the orbit",
    "r_max": "largest distance r on the orbit",
    "period": "period S(g)",
    "action": "action J(g), J′ = −g S",
    "variance": "variance σ²(g) = A² J/S per unit of s",
    "drift": "drift −A²g/2 per unit of s",
    "stationary_density": "stationary density S/∫S of |G|",
}
_FAMILIES = ("even", "odd")


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
    return energy_tables(process.potential, process.noise, n_energies, n_eigenvalues)


@recorded()
def energy_tables(
    potential: Potential, noise: float, n_energies: int, n_eigenvalues: int
) -> xr.Dataset:
    """The same of ``EnergyProcess(potential, noise)``.

    Parameters
    ----------
    potential : Potential
    noise : float
    n_energies, n_eigenvalues : int
    """
    import xarray as xr

    from fpsolve.reduced.energy.process import EnergyProcess

    process = EnergyProcess(potential, noise)

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
        **process_attributes(process, {}),
        **made_with(),
    }
    return marked(xr.Dataset(variables, coordinates, attributes), "energy-tables")
