"""A fibre in the air of the process: what flows around it, and what that does to it."""

from fpsolve.fibre.drag import drag_coefficients, drag_force, drag_resistances
from fpsolve.fibre.turbulence import TurbulenceSpectrum

__all__ = [
    "TurbulenceSpectrum",
    "drag_coefficients",
    "drag_force",
    "drag_resistances",
]
