"""The hydrodynamic limit: what is left of the angle when the noise is large."""

from fpsolve.reduced.hydrodynamic.initial_layer import InitialLayer
from fpsolve.reduced.hydrodynamic.limit import HydrodynamicLimit
from fpsolve.reduced.hydrodynamic.ornstein_uhlenbeck import OrnsteinUhlenbeckLimit
from fpsolve.reduced.hydrodynamic.reconstruction import reconstruct
from fpsolve.reduced.hydrodynamic.sampling import HydrodynamicPaths
from fpsolve.reduced.hydrodynamic.solution import (
    HydrodynamicSolution,
    HydrodynamicSteadyState,
)
from fpsolve.reduced.hydrodynamic.spectrum import HydrodynamicSpectrum

__all__ = [
    "HydrodynamicLimit",
    "HydrodynamicPaths",
    "HydrodynamicSolution",
    "HydrodynamicSpectrum",
    "HydrodynamicSteadyState",
    "InitialLayer",
    "OrnsteinUhlenbeckLimit",
    "reconstruct",
]
