"""Buckling potentials B(ξ): what pulls the fibre back to the reference curve."""

from fpsolve.model.potentials.dictionaries import potential_from_dict, potential_to_dict
from fpsolve.model.potentials.free import FreePotential
from fpsolve.model.potentials.linear import LinearPotential
from fpsolve.model.potentials.potential import Potential
from fpsolve.model.potentials.power import PowerPotential
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.model.potentials.user import CallablePotential, IsotropicPotential

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
