"""Figures of solutions and of paths; each function returns a matplotlib Figure.

The figures belong to no window: nothing is shown and pyplot keeps no record of them.
Save one with ``figure.savefig(path)``; a notebook shows it when it is the last value
of a cell.
"""

import importlib
from typing import TYPE_CHECKING, Any

from fpsolve.plotting.angle import plot_angle
from fpsolve.plotting.ensembles import plot_ensemble
from fpsolve.plotting.entropy import plot_entropy
from fpsolve.plotting.files import save_figures
from fpsolve.plotting.marginals import plot_marginals
from fpsolve.plotting.moments import plot_moments
from fpsolve.plotting.movie import movie
from fpsolve.plotting.overview import plot_overview
from fpsolve.plotting.trajectories import (
    plot_fibre,
    plot_nozzles,
    plot_trajectories,
)

if TYPE_CHECKING:
    from fpsolve.plotting.comparison import plot_cross_check
    from fpsolve.plotting.differences import plot_comparison
    from fpsolve.plotting.energy import (
        plot_energy_coefficients,
        plot_energy_eigenfunctions,
        plot_energy_law,
        plot_orbits,
    )
    from fpsolve.plotting.ergodicity import plot_ergodic_averages
    from fpsolve.plotting.hydrodynamic import plot_hydrodynamic
    from fpsolve.plotting.limits import plot_large_noise
    from fpsolve.plotting.rates import (
        plot_asymptotic_variance,
        plot_inverse_decay_rate,
        plot_rates,
        plot_spectrum,
    )
    from fpsolve.plotting.small_noise import (
        plot_small_noise,
        plot_small_noise_spectrum,
    )

__all__ = [
    "movie",
    "plot_angle",
    "plot_asymptotic_variance",
    "plot_comparison",
    "plot_cross_check",
    "plot_energy_coefficients",
    "plot_energy_eigenfunctions",
    "plot_energy_law",
    "plot_ensemble",
    "plot_entropy",
    "plot_ergodic_averages",
    "plot_fibre",
    "plot_hydrodynamic",
    "plot_inverse_decay_rate",
    "plot_large_noise",
    "plot_marginals",
    "plot_moments",
    "plot_nozzles",
    "plot_orbits",
    "plot_overview",
    "plot_rates",
    "plot_small_noise",
    "plot_small_noise_spectrum",
    "plot_spectrum",
    "plot_trajectories",
    "save_figures",
]

# Figures of studies, which are loaded on first use.
_STUDIES = {
    "plot_asymptotic_variance": "fpsolve.plotting.rates",
    "plot_comparison": "fpsolve.plotting.differences",
    "plot_cross_check": "fpsolve.plotting.comparison",
    "plot_energy_coefficients": "fpsolve.plotting.energy",
    "plot_energy_eigenfunctions": "fpsolve.plotting.energy",
    "plot_energy_law": "fpsolve.plotting.energy",
    "plot_ergodic_averages": "fpsolve.plotting.ergodicity",
    "plot_hydrodynamic": "fpsolve.plotting.hydrodynamic",
    "plot_inverse_decay_rate": "fpsolve.plotting.rates",
    "plot_large_noise": "fpsolve.plotting.limits",
    "plot_orbits": "fpsolve.plotting.energy",
    "plot_rates": "fpsolve.plotting.rates",
    "plot_small_noise": "fpsolve.plotting.small_noise",
    "plot_small_noise_spectrum": "fpsolve.plotting.small_noise",
    "plot_spectrum": "fpsolve.plotting.rates",
}


def __getattr__(name: str) -> Any:
    if name in _STUDIES:
        return getattr(importlib.import_module(_STUDIES[name]), name)
    raise AttributeError(f"module 'fpsolve.plotting' has no attribute {name!r}")
