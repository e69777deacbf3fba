"""Operators, each one equation, and the compositions that are the schemes."""

from fpsolve.density.schemes.drift_kick import DriftKick
from fpsolve.density.schemes.semi_lagrangian import SemiLagrangian
from fpsolve.density.smooth.smooth_drift_kick import SmoothDriftKick

__all__ = [
    "DriftKick",
    "SemiLagrangian",
    "SmoothDriftKick",
    "drift_kick",
    "semi_lagrangian",
    "smooth_drift_kick",
]

drift_kick = DriftKick
semi_lagrangian = SemiLagrangian
smooth_drift_kick = SmoothDriftKick
