"""Little noise: the energy of a fibre's orbit as a diffusion on an interval."""

from fpsolve.reduced.energy.grid import EnergyGrid
from fpsolve.reduced.energy.orbit import Orbit
from fpsolve.reduced.energy.passage import Passage
from fpsolve.reduced.energy.process import EnergyProcess
from fpsolve.reduced.energy.sampling import EnergyPaths
from fpsolve.reduced.energy.solution import EnergySolution
from fpsolve.reduced.energy.spectrum import EnergySpectrum

__all__ = [
    "EnergyGrid",
    "EnergyPaths",
    "EnergyProcess",
    "EnergySolution",
    "EnergySpectrum",
    "Orbit",
    "Passage",
]
