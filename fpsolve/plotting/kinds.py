"""The figures of every kind of result: their names, and what draws them."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

from fpsolve._support.declared import declared
from fpsolve.paths.result import Paths
from fpsolve.plotting.angle import plot_angle
from fpsolve.plotting.comparison import plot_cross_check
from fpsolve.plotting.design import plot_web_design
from fpsolve.plotting.energy import (
    plot_energy_coefficients,
    plot_energy_eigenfunctions,
    plot_energy_law,
    plot_orbits,
)
from fpsolve.plotting.ensembles import plot_ensemble
from fpsolve.plotting.entropy import has_entropy, plot_entropy
from fpsolve.plotting.ergodicity import plot_ergodic_averages
from fpsolve.plotting.fibre_curve import plot_fibre_curve
from fpsolve.plotting.fibre_motion import plot_lay_down, plot_motion
from fpsolve.plotting.fibres import plot_fibre
from fpsolve.plotting.homogeneity import plot_web_homogeneity
from fpsolve.plotting.hydrodynamic import plot_hydrodynamic
from fpsolve.plotting.identification import plot_identified_fibres, plot_increments
from fpsolve.plotting.limits import plot_large_noise, plot_white_noise
from fpsolve.plotting.marginals import plot_marginals
from fpsolve.plotting.moments import plot_moments
from fpsolve.plotting.nozzle_design import plot_nozzle_design
from fpsolve.plotting.overview import plot_overview
from fpsolve.plotting.pattern import plot_pattern
from fpsolve.plotting.periodic import plot_periodic_state
from fpsolve.plotting.predicted_web import plot_predicted_web
from fpsolve.plotting.rates import (
    plot_asymptotic_variance,
    plot_inverse_decay_rate,
    plot_rates,
)
from fpsolve.plotting.selection import potential_of
from fpsolve.plotting.series import (
    plot_energy_paths,
    plot_hydrodynamic_paths,
    plot_smooth_spectral,
    plot_spectral,
)
from fpsolve.plotting.small_noise import plot_small_noise, plot_small_noise_spectrum
from fpsolve.plotting.spectrum import plot_spectrum
from fpsolve.plotting.stationary import plot_steady_state
from fpsolve.plotting.trajectories import plot_trajectories
from fpsolve.plotting.web_image import holds_fibre
from fpsolve.plotting.web_quality import holds_zones, plot_rose, plot_variation
from fpsolve.plotting.web_spectrum import holds_blocks, plot_web_spectrum
from fpsolve.plotting.webs import plot_mass, plot_web
from fpsolve.reduced.energy.process import EnergyProcess

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    Plot = Callable[[Any], Figure]
    Figures = dict[str, Plot]

__all__ = ["FIGURES"]

# One has no curve, and nothing is fitted to it.
FEWEST_NOISES = 2


def each(**figures: tuple[Plot, Callable[[Any], bool]]) -> Callable[[Any], Figures]:
    """Return what names the figures that a result allows, of these with conditions."""

    def allowed(result: Any) -> Figures:
        return {name: plot for name, (plot, needs) in figures.items() if needs(result)}

    return allowed


def always(result: Any) -> bool:
    """Of every result of its kind."""
    return True


def saved(solution: Any) -> bool:
    """Where a density was saved."""
    return len(solution.saved_s) > 0


def recorded(solution: Any) -> bool:
    """Where there are numbers over s."""
    return len(solution.series["s"]) > 0


def known(*names: str) -> Callable[[xr.Dataset], bool]:
    """Where a study has computed one of these variables."""

    def computed(dataset: xr.Dataset) -> bool:
        return any(name in dataset and dataset[name].notnull().any() for name in names)

    return computed


def replayed(paths: Paths) -> bool:
    """Where a path can be run again, which needs its model and its start."""
    return paths.model is not None and (paths.kept or paths.initial is not None)


def of_energy_tables(dataset: xr.Dataset) -> Figures:
    """Of the energy process orbits, coefficients and modes."""
    potential = potential_of(dataset)
    # Without a user's own there are no orbits.
    if potential is None:
        return {}
    process = EnergyProcess(potential, declared(dataset.attrs)["noise"])
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
    "solution": each(
        overview=(plot_overview, saved),
        marginals=(plot_marginals, saved),
        angle=(plot_angle, saved),
        entropy=(plot_entropy, has_entropy),
        moments=(plot_moments, recorded),
    ),
    "paths": each(
        ensemble=(plot_ensemble, always),
        trajectory=(plot_trajectories, lambda p: replayed(p) and p.model.curve.fixed),
        fibre=(plot_fibre, lambda p: replayed(p) and not p.model.curve.fixed),
    ),
    "fibre-curve": each(fibre=(plot_fibre_curve, always)),
    "fibre-motion": each(motion=(plot_motion, always)),
    "fibre-lay-down": each(lay_down=(plot_lay_down, always)),
    "hydrodynamic": each(hydrodynamic=(plot_hydrodynamic, saved)),
    "energy": each(law=(plot_energy_law, saved)),
    "steady-state": each(stationary=(plot_steady_state, always)),
    "periodic-state": each(phases=(plot_periodic_state, always)),
    "spectral": each(series=(plot_spectral, always)),
    "smooth-spectral": each(series=(plot_smooth_spectral, always)),
    # A density on whatever grid is chosen, and none before.
    "spectral-steady-state": each(),
    "smooth-spectral-steady-state": each(),
    "energy-paths": each(energies=(plot_energy_paths, always)),
    "hydrodynamic-paths": each(moments=(plot_hydrodynamic_paths, always)),
    "web": each(
        light=(plot_web, holds_fibre),
        mass=(plot_mass, holds_fibre),
        variation=(plot_variation, holds_zones),
        rose=(plot_rose, holds_fibre),
        spectrum=(plot_web_spectrum, holds_blocks),
    ),
    "mean-pattern": each(pattern=(plot_pattern, always)),
    "check": each(check=(plot_cross_check, always)),
    # Beside the model that they are of.
    "spectrum": each(spectrum=(plot_spectrum, lambda found: found.model is not None)),
    "web-prediction": each(zones=(plot_predicted_web, always)),
    "identification": each(
        fibres=(plot_identified_fibres, lambda found: found.model is not None),
        increments=(plot_increments, always),
    ),
    "identification-comparison": each(
        fibres=(plot_identified_fibres, lambda found: found.basic.model is not None),
        increments=(plot_increments, always),
    ),
    "rate": each(
        integral=(plot_inverse_decay_rate, known("inverse_decay_rate")),
        rates=(plot_rates, known("gap", "branch_rate")),
        averages=(plot_asymptotic_variance, known("asymptotic_variance")),
    ),
    "large-noise": each(distances=(plot_large_noise, known("distance"))),
    "white-noise": each(distances=(plot_white_noise, known("distance"))),
    "web-homogeneity": each(zones=(plot_web_homogeneity, known("z"))),
    "web-design": each(design=(plot_web_design, always)),
    "nozzle-design": each(pattern=(plot_nozzle_design, always)),
    "small-noise": each(distances=(plot_small_noise, known("distance"))),
    "small-noise-spectrum": each(spectrum=(plot_small_noise_spectrum, always)),
    "energy-tables": of_energy_tables,
    "averages": of_averages,
}


def _drawn(plot: Plot, shown: Any, result: Any) -> Figure:
    """Draw what a result is about, and not the result."""
    return plot(shown)
