"""Fokker-Planck solvers for stochastic fibre lay-down.

The public names are loaded on first use, so that importing the package costs
milliseconds.
"""

from __future__ import annotations

import importlib
import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fpsolve import diagnostics, errors, initial, interop, paths, plotting, studies
    from fpsolve.checkpoints import Checkpoint
    from fpsolve.comparisons import Comparison, compare
    from fpsolve.curves import (
        EllipticNozzle,
        FixedBelt,
        MovingBelt,
        OscillatingNozzle,
        RotatingNozzle,
        TabulatedCurve,
    )
    from fpsolve.errors import (
        CheckpointError,
        CheckpointMismatchError,
        CirculationError,
        ConfigurationError,
        DomainTooSmallError,
        EntropyRiseError,
        FileFormatError,
        FpsolveError,
        GridMismatchError,
        MassCorrectionError,
        MassDriftError,
        MemoryLimitError,
        NegativeDensityError,
        NonFiniteDensityError,
        NonFinitePathError,
        NotRepeatableError,
        RunInterrupted,
        SteadyStateError,
    )
    from fpsolve.grids import PhaseSpaceGrid
    from fpsolve.interop import from_pde_field, to_pde_field
    from fpsolve.io import load
    from fpsolve.models import LayDownModel
    from fpsolve.paths import Paths, sample_paths
    from fpsolve.planes import PlaneGrid
    from fpsolve.potentials import (
        CallablePotential,
        FreePotential,
        IsotropicPotential,
        LinearPotential,
        PowerPotential,
        QuadraticPotential,
    )
    from fpsolve.process import Process
    from fpsolve.reduced.energy import EnergyProcess
    from fpsolve.reduced.hydrodynamic import HydrodynamicLimit, OrnsteinUhlenbeckLimit
    from fpsolve.report import report
    from fpsolve.rerunning import rerun
    from fpsolve.resuming import resume
    from fpsolve.schemes import drift_kick, semi_lagrangian
    from fpsolve.solution import Solution
    from fpsolve.solve import solve
    from fpsolve.spectral.evolution import spectral_solve
    from fpsolve.spectral.gap import SpectralGap, spectral_gap
    from fpsolve.spectral.optimal import OptimalNoise, optimal_noise
    from fpsolve.spectral.solution import SpectralSolution
    from fpsolve.spectral.spectrum import Spectrum, spectrum
    from fpsolve.spectral.steady import SpectralSteadyState, spectral_steady_state
    from fpsolve.steady_state import SteadyState, steady_state
    from fpsolve.suggestions import suggest_grid, suggest_step

_MODULES = {
    "fpsolve.checkpoints": "Checkpoint",
    "fpsolve.comparisons": "Comparison compare",
    "fpsolve.curves": (
        "EllipticNozzle FixedBelt MovingBelt OscillatingNozzle RotatingNozzle "
        "TabulatedCurve"
    ),
    "fpsolve.errors": (
        "CheckpointError CheckpointMismatchError CirculationError "
        "ConfigurationError DomainTooSmallError EntropyRiseError FileFormatError "
        "FpsolveError "
        "GridMismatchError MassCorrectionError MassDriftError MemoryLimitError "
        "NegativeDensityError NonFiniteDensityError NonFinitePathError "
        "NotRepeatableError RunInterrupted SteadyStateError"
    ),
    "fpsolve.grids": "PhaseSpaceGrid",
    "fpsolve.interop": "from_pde_field to_pde_field",
    "fpsolve.io": "load",
    "fpsolve.models": "LayDownModel",
    "fpsolve.paths": "Paths sample_paths",
    "fpsolve.planes": "PlaneGrid",
    "fpsolve.potentials": (
        "CallablePotential FreePotential IsotropicPotential LinearPotential "
        "PowerPotential QuadraticPotential"
    ),
    "fpsolve.process": "Process",
    "fpsolve.reduced.energy": "EnergyProcess",
    "fpsolve.reduced.hydrodynamic": "HydrodynamicLimit OrnsteinUhlenbeckLimit",
    "fpsolve.resuming": "resume",
    "fpsolve.report": "report",
    "fpsolve.rerunning": "rerun",
    "fpsolve.schemes": "drift_kick semi_lagrangian",
    "fpsolve.solution": "Solution",
    "fpsolve.solve": "solve",
    "fpsolve.spectral.evolution": "spectral_solve",
    "fpsolve.spectral.gap": "SpectralGap spectral_gap",
    "fpsolve.spectral.optimal": "OptimalNoise optimal_noise",
    "fpsolve.spectral.solution": "SpectralSolution",
    "fpsolve.spectral.spectrum": "Spectrum spectrum",
    "fpsolve.spectral.steady": "SpectralSteadyState spectral_steady_state",
    "fpsolve.steady_state": "SteadyState steady_state",
    "fpsolve.suggestions": "suggest_grid suggest_step",
}
_SUBMODULES = (
    "diagnostics", "errors", "initial", "interop", "paths", "plotting", "studies",
)  # fmt: skip
_HOME = {name: home for home, names in _MODULES.items() for name in names.split()}

__all__ = [
    "CallablePotential",
    "Checkpoint",
    "CheckpointError",
    "CheckpointMismatchError",
    "CirculationError",
    "Comparison",
    "ConfigurationError",
    "DomainTooSmallError",
    "EllipticNozzle",
    "EnergyProcess",
    "EntropyRiseError",
    "FileFormatError",
    "FixedBelt",
    "FpsolveError",
    "FreePotential",
    "GridMismatchError",
    "HydrodynamicLimit",
    "IsotropicPotential",
    "LayDownModel",
    "LinearPotential",
    "MassCorrectionError",
    "MassDriftError",
    "MemoryLimitError",
    "MovingBelt",
    "NegativeDensityError",
    "NonFiniteDensityError",
    "NonFinitePathError",
    "NotRepeatableError",
    "OptimalNoise",
    "OrnsteinUhlenbeckLimit",
    "OscillatingNozzle",
    "Paths",
    "PhaseSpaceGrid",
    "PlaneGrid",
    "PowerPotential",
    "Process",
    "QuadraticPotential",
    "RotatingNozzle",
    "RunInterrupted",
    "Solution",
    "SpectralGap",
    "SpectralSolution",
    "SpectralSteadyState",
    "Spectrum",
    "SteadyState",
    "SteadyStateError",
    "TabulatedCurve",
    "compare",
    "diagnostics",
    "drift_kick",
    "errors",
    "from_pde_field",
    "initial",
    "interop",
    "load",
    "optimal_noise",
    "paths",
    "plotting",
    "report",
    "rerun",
    "resume",
    "sample_paths",
    "semi_lagrangian",
    "solve",
    "spectral_gap",
    "spectral_solve",
    "spectral_steady_state",
    "spectrum",
    "steady_state",
    "studies",
    "suggest_grid",
    "suggest_step",
    "to_pde_field",
]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("fpsolve")
    if name in _SUBMODULES:
        return importlib.import_module(f"fpsolve.{name}")
    if name in _HOME:
        value = getattr(importlib.import_module(_HOME[name]), name)
        globals()[name] = value
        return value
    raise AttributeError(f"module 'fpsolve' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)


class _Package(ModuleType):
    """The package, in which `fpsolve.solve` stays the function of that name.

    Importing the module fpsolve.solve would bind it to the same name.
    """

    def __setattr__(self, name: str, value: object) -> None:
        if not (name in _HOME and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
