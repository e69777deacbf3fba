"""The basic model (6) path by path: the independent witness for the grid solver."""

from fpsolve.paths.histogram import Histogram
from fpsolve.paths.laws import DensityLaw, EquilibriumLaw, GaussianLaw, PointLaw
from fpsolve.paths.moments import Moments
from fpsolve.paths.result import Paths
from fpsolve.paths.sampling import sample_paths
from fpsolve.paths.trajectory import Trajectory

__all__ = [
    "DensityLaw",
    "EquilibriumLaw",
    "GaussianLaw",
    "Histogram",
    "Moments",
    "Paths",
    "PointLaw",
    "Trajectory",
    "sample_paths",
]
