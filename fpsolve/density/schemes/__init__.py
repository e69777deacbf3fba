"""Operators, each one equation, and the compositions that are the schemes."""

from fpsolve.density.schemes.drift_kick import DriftKick
from fpsolve.density.schemes.semi_lagrangian import SemiLagrangian

__all__ = ["DriftKick", "SemiLagrangian", "drift_kick", "semi_lagrangian"]

drift_kick = DriftKick
semi_lagrangian = SemiLagrangian
