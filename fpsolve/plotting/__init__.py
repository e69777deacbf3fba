"""Figures of a solution; each function returns a matplotlib Figure.

The figures belong to no window: nothing is shown and pyplot keeps no record of them.
Save one with ``figure.savefig(path)``; a notebook shows it when it is the last value
of a cell.
"""

from fpsolve.plotting.angle import plot_angle
from fpsolve.plotting.entropy import plot_entropy
from fpsolve.plotting.files import save_figures
from fpsolve.plotting.marginals import plot_marginals
from fpsolve.plotting.moments import plot_moments
from fpsolve.plotting.movie import movie
from fpsolve.plotting.overview import plot_overview

__all__ = [
    "movie",
    "plot_angle",
    "plot_entropy",
    "plot_marginals",
    "plot_moments",
    "plot_overview",
    "save_figures",
]
