"""The schemes of fpsolve, by the names that files and configurations call them."""

from typing import Any

from fpsolve.density.schemes.drift_kick import DriftKick
from fpsolve.density.schemes.semi_lagrangian import SemiLagrangian
from fpsolve.density.smooth.smooth_drift_kick import SmoothDriftKick

__all__ = ["SCHEMES"]

# A row is all that a new scheme needs to be described, read back and configured.
SCHEMES: dict[str, type[Any]] = {
    "drift_kick": DriftKick,
    "semi_lagrangian": SemiLagrangian,
    "smooth_drift_kick": SmoothDriftKick,
}
