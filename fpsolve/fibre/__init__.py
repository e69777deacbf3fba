"""A fibre in the air: where it rests, how it moves, and how air pulls at it."""

from fpsolve.fibre.air import AirFlow
from fpsolve.fibre.drag import drag_coefficients, drag_force, drag_resistances
from fpsolve.fibre.ends import Clamped, Free, Hinged
from fpsolve.fibre.motion import Motion, simulate
from fpsolve.fibre.random_force import RandomForce
from fpsolve.fibre.rest import Equilibrium, equilibrium
from fpsolve.fibre.string import String
from fpsolve.fibre.turbulence import TurbulenceSpectrum
from fpsolve.fibre.vibrations import Modes, modes

__all__ = [
    "AirFlow",
    "Clamped",
    "Equilibrium",
    "Free",
    "Hinged",
    "Modes",
    "Motion",
    "RandomForce",
    "String",
    "TurbulenceSpectrum",
    "drag_coefficients",
    "drag_force",
    "drag_resistances",
    "equilibrium",
    "modes",
    "simulate",
]
