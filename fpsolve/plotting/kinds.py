"""The figures of every kind of result: their names, and what draws them."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

from fpsolve.density.solution import Solution
from fpsolve.paths.result import Paths
from fpsolve.plotting.angle import plot_angle
from fpsolve.plotting.comparison import plot_cross_check
from fpsolve.plotting.energy import (
    plot_energy_coefficients,
    plot_energy_eigenfunctions,
    plot_energy_law,
    plot_orbits,
)
from fpsolve.plotting.ensembles import plot_ensemble
from fpsolve.plotting.entropy import has_entropy, plot_entropy
from fpsolve.plotting.ergodicity import plot_ergodic_averages
from fpsolve.plotting.hydrodynamic import plot_hydrodynamic
from fpsolve.plotting.limits import plot_large_noise
from fpsolve.plotting.marginals import plot_marginals
from fpsolve.plotting.moments import plot_moments
from fpsolve.plotting.overview import plot_overview
from fpsolve.plotting.rates import (
    plot_asymptotic_variance,
    plot_inverse_decay_rate,
    plot_rates,
    plot_spectrum,
)
from fpsolve.plotting.series import (
    plot_energy_paths,
    plot_hydrodynamic_paths,
    plot_spectral,
)
from fpsolve.plotting.small_noise import plot_small_noise, plot_small_noise_spectrum
from fpsolve.plotting.stationary import plot_steady_state
from fpsolve.plotting.trajectories import plot_fibre, plot_trajectories

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    Figures = dict[str, Callable[[Any], Figure]]

__all__ = ["FIGURES"]

# One has no curve, and nothing is fitted to it.
FEWEST_NOISES = 2


def of_solution(solution: Solution) -> Figures:
    """Of a density what was saved and recorded."""
    figures: Figures = {}
    if len(solution.saved_s):
        figures["overview"] = plot_overview
        figures["marginals"] = plot_marginals
        figures["angle"] = plot_angle
    if has_entropy(solution):
        figures["entropy"] = plot_entropy
    if len(solution.series["s"]):
        figures["moments"] = plot_moments
    return figures


def of_paths(paths: Paths) -> Figures:
    """Of paths their law, and one of them."""
    figures: Figures = {"ensemble": plot_ensemble}
    # Without its model or its start no path can be run again.
    if paths.model is None or not (paths.kept or paths.initial is not None):
        return figures
    if paths.model.curve.fixed:
        return {**figures, "trajectory": plot_trajectories}
    return {**figures, "fibre": plot_fibre}


def of_hydrodynamic(solution: Any) -> Figures:
    """Of the limit of much noise what was saved."""
    return {"hydrodynamic": plot_hydrodynamic} if len(solution.saved_s) else {}


def of_energy(solution: Any) -> Figures:
    """Of the energy its law, where it was saved."""
    return {"law": plot_energy_law} if len(solution.saved_s) else {}


def of_spectrum(found: Any) -> Figures:
    """Of a spectrum its eigenvalues, beside the model that they are of."""
    return {"spectrum": plot_spectrum} if found.model is not None else {}


def of_rates(dataset: xr.Dataset) -> Figures:
    """Of a study of rates what its parts computed."""
    figures: Figures = {}
    if _known(dataset, "inverse_decay_rate"):
        figures["integral"] = plot_inverse_decay_rate
    if _known(dataset, "gap") or _known(dataset, "branch_rate"):
        figures["rates"] = plot_rates
    if _known(dataset, "asymptotic_variance"):
        figures["averages"] = plot_asymptotic_variance
    return figures


def of_large_noise(dataset: xr.Dataset) -> Figures:
    """Of the limit of much noise the distances."""
    return {"distances": plot_large_noise} if _known(dataset, "distance") else {}


def of_small_noise(dataset: xr.Dataset) -> Figures:
    """Of the limit of little noise the distances."""
    return {"distances": plot_small_noise} if _known(dataset, "distance") else {}


def of_energy_tables(dataset: xr.Dataset) -> Figures:
    """Of the energy process orbits, coefficients and modes."""
    from fpsolve._support.declared import declared
    from fpsolve.model.potentials.dictionaries import potential_from_dict
    from fpsolve.reduced.energy.process import EnergyProcess

    about = declared(dataset.attrs)
    try:
        potential = potential_from_dict(about["potential"])
    # A user's own, without which there are no orbits.
    except ValueError:
        return {}
    process = EnergyProcess(potential, about["noise"])
    drawn = {
        "orbits": plot_orbits, "coefficients": plot_energy_coefficients,
        "eigenfunctions": plot_energy_eigenfunctions,
    }  # fmt: skip
    return {name: partial(_drawn, plot, process) for name, plot in drawn.items()}


def of_averages(dataset: xr.Dataset) -> Figures:
    """Of averages the first function, and all variances, against the noise."""
    if dataset.sizes["noise"] < FEWEST_NOISES:
        return {}
    names = [str(name) for name in dataset["function"].to_numpy()]
    shown = "square" if "square" in names else names[0]
    return {"averages": partial(plot_ergodic_averages, function=shown)}


# By the kind of a result; what returns the figures that it allows.
FIGURES: dict[str, Callable[[Any], Figures]] = {
    "solution": of_solution,
    "paths": of_paths,
    "hydrodynamic": of_hydrodynamic,
    "energy": of_energy,
    "steady-state": lambda result: {"stationary": plot_steady_state},
    "spectral": lambda solution: {"series": plot_spectral},
    # A density on whatever grid is chosen, and none before.
    "spectral-steady-state": lambda result: {},
    "energy-paths": lambda paths: {"energies": plot_energy_paths},
    "hydrodynamic-paths": lambda paths: {"moments": plot_hydrodynamic_paths},
    "check": lambda check: {"check": plot_cross_check},
    "spectrum": of_spectrum,
    "rate": of_rates,
    "large-noise": of_large_noise,
    "small-noise": of_small_noise,
    "small-noise-spectrum": lambda dataset: {"spectrum": plot_small_noise_spectrum},
    "energy-tables": of_energy_tables,
    "averages": of_averages,
}


def _known(dataset: xr.Dataset, name: str) -> bool:
    return name in dataset and bool(dataset[name].notnull().any())


def _drawn(plot: Callable[[Any], Figure], shown: Any, result: Any) -> Figure:
    """Draw what a result is about, and not the result."""
    return plot(shown)
