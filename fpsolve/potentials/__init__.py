"""Buckling potentials B(ξ): what pulls the fibre back to the reference curve."""

from fpsolve.potentials.dictionaries import potential_from_dict, potential_to_dict
from fpsolve.potentials.free import FreePotential
from fpsolve.potentials.linear import LinearPotential
from fpsolve.potentials.potential import Potential
from fpsolve.potentials.power import PowerPotential
from fpsolve.potentials.quadratic import QuadraticPotential
from fpsolve.potentials.user import CallablePotential, IsotropicPotential

__all__ = [
    "CallablePotential",
    "FreePotential",
    "IsotropicPotential",
    "LinearPotential",
    "Potential",
    "PowerPotential",
    "QuadraticPotential",
    "potential_from_dict",
    "potential_to_dict",
]
