"""py-pde: our equations for its solvers, our schemes as its solvers, fields to and fro.

Importing this package imports py-pde and registers the solvers "semi-lagrangian",
"drift-kick" and "scharfetter-gummel" with it. Nothing below floor 6 imports it, and
`import fpsolve` does not.
"""

from fpsolve.interop.fields import from_pde_field, to_pde_field
from fpsolve.interop.hydrodynamic import ScharfetterGummelSolver
from fpsolve.interop.pypde import FokkerPlanckPDE, HydrodynamicPDE
from fpsolve.interop.solvers import DriftKickSolver, SemiLagrangianSolver
from fpsolve.interop.trackers import GifMovie, entropy_tracker, relative_entropy

__all__ = [
    "DriftKickSolver",
    "FokkerPlanckPDE",
    "GifMovie",
    "HydrodynamicPDE",
    "ScharfetterGummelSolver",
    "SemiLagrangianSolver",
    "entropy_tracker",
    "from_pde_field",
    "relative_entropy",
    "to_pde_field",
]
