"""Results of the energy process from their datasets; see `evolution.saved.restored`."""

from functools import partial

from fpsolve.evolution.saved import restored
from fpsolve.reduced.energy.process import EnergyProcess
from fpsolve.reduced.energy.sampling import EnergyPaths
from fpsolve.reduced.energy.solution import EnergySolution

__all__ = ["read_paths", "read_solution"]

read_solution = partial(restored, EnergySolution, process=EnergyProcess)
read_paths = partial(restored, EnergyPaths, process=EnergyProcess)
