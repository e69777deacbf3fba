"""The names of this package, and where each of them lives."""

from .angle import plot_angle as plot_angle
from .comparison import plot_cross_check as plot_cross_check
from .differences import plot_comparison as plot_comparison
from .energy import plot_energy_coefficients as plot_energy_coefficients
from .energy import plot_energy_eigenfunctions as plot_energy_eigenfunctions
from .energy import plot_energy_law as plot_energy_law
from .energy import plot_orbits as plot_orbits
from .ensembles import plot_ensemble as plot_ensemble
from .entropy import plot_entropy as plot_entropy
from .ergodicity import plot_ergodic_averages as plot_ergodic_averages
from .files import save_figures as save_figures
from .hydrodynamic import plot_hydrodynamic as plot_hydrodynamic
from .limits import plot_large_noise as plot_large_noise
from .marginals import plot_marginals as plot_marginals
from .moments import plot_moments as plot_moments
from .movie import movie as movie
from .overview import plot_overview as plot_overview
from .rates import plot_asymptotic_variance as plot_asymptotic_variance
from .rates import plot_inverse_decay_rate as plot_inverse_decay_rate
from .rates import plot_rates as plot_rates
from .rates import plot_spectrum as plot_spectrum
from .small_noise import plot_small_noise as plot_small_noise
from .small_noise import plot_small_noise_spectrum as plot_small_noise_spectrum
from .trajectories import plot_fibre as plot_fibre
from .trajectories import plot_nozzles as plot_nozzles
from .trajectories import plot_trajectories as plot_trajectories
