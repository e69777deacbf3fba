"""A fibre in the air: where it rests, how it moves, and how air pulls at it."""

from fpsolve.fibre.air import AirFlow
from fpsolve.fibre.drag import drag_coefficients, drag_force, drag_resistances
from fpsolve.fibre.ends import Belt, Clamped, Free, Hinged, Nozzle
from fpsolve.fibre.laid import LayDown
from fpsolve.fibre.lay_all import lay_down_all
from fpsolve.fibre.laying import lay_down
from fpsolve.fibre.motion import Motion
from fpsolve.fibre.random_force import RandomForce
from fpsolve.fibre.rest import Equilibrium, equilibrium
from fpsolve.fibre.simulating import simulate
from fpsolve.fibre.string import String
from fpsolve.fibre.turbulence import TurbulenceSpectrum
from fpsolve.fibre.turbulent_force import TurbulentForce
from fpsolve.fibre.vibrations import Modes, modes

__all__ = [
    "AirFlow",
    "Belt",
    "Clamped",
    "Equilibrium",
    "Free",
    "Hinged",
    "LayDown",
    "Modes",
    "Motion",
    "Nozzle",
    "RandomForce",
    "String",
    "TurbulenceSpectrum",
    "TurbulentForce",
    "drag_coefficients",
    "drag_force",
    "drag_resistances",
    "equilibrium",
    "lay_down",
    "lay_down_all",
    "modes",
    "simulate",
]
