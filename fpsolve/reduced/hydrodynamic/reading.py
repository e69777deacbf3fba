"""A solution of the limit from its dataset; see `evolution.saved.restored`."""

from functools import partial

from fpsolve.evolution.saved import restored
from fpsolve.reduced.hydrodynamic.limit import HydrodynamicLimit
from fpsolve.reduced.hydrodynamic.solution import HydrodynamicSolution

__all__ = ["read_solution"]

read_solution = partial(restored, HydrodynamicSolution, limit=HydrodynamicLimit)
