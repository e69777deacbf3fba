"""The public names and where each of them lives: `__init__.py` reads this table."""

from . import errors as errors
from . import fibre as fibre
from . import interop as interop
from . import paths as paths
from . import plotting as plotting
from . import studies as studies
from .density.checkpoints import Checkpoint as Checkpoint
from .density.periodic_state import PeriodicState as PeriodicState
from .density.periodic_state import periodic_state as periodic_state
from .density.resume import resume as resume
from .density.schemes import drift_kick as drift_kick
from .density.schemes import semi_lagrangian as semi_lagrangian
from .density.smooth import smooth_drift_kick as smooth_drift_kick
from .density.solution import Solution as Solution
from .density.solve import solve as solve
from .density.steady_state import SteadyState as SteadyState
from .density.steady_state import steady_state as steady_state
from .density.suggestions import suggest_step as suggest_step
from .errors import CheckpointError as CheckpointError
from .errors import CheckpointMismatchError as CheckpointMismatchError
from .errors import CirculationError as CirculationError
from .errors import ConfigurationError as ConfigurationError
from .errors import CurvatureRangeError as CurvatureRangeError
from .errors import DomainTooSmallError as DomainTooSmallError
from .errors import EdgeLengthError as EdgeLengthError
from .errors import EntropyRiseError as EntropyRiseError
from .errors import EquilibriumError as EquilibriumError
from .errors import FileFormatError as FileFormatError
from .errors import FlowRangeError as FlowRangeError
from .errors import FpsolveError as FpsolveError
from .errors import FrictionError as FrictionError
from .errors import GridMismatchError as GridMismatchError
from .errors import MassCorrectionError as MassCorrectionError
from .errors import MassDriftError as MassDriftError
from .errors import MemoryLimitError as MemoryLimitError
from .errors import NegativeDensityError as NegativeDensityError
from .errors import NoiseStrengthError as NoiseStrengthError
from .errors import NonFiniteDensityError as NonFiniteDensityError
from .errors import NonFinitePathError as NonFinitePathError
from .errors import NotRepeatableError as NotRepeatableError
from .errors import ObservationError as ObservationError
from .errors import RunInterrupted as RunInterrupted
from .errors import SteadyStateError as SteadyStateError
from .grids import diagnostics as diagnostics
from .grids import initial as initial
from .grids.phase_space import PhaseSpaceGrid as PhaseSpaceGrid
from .grids.plane import PlaneGrid as PlaneGrid
from .grids.smooth import SmoothPhaseSpaceGrid as SmoothPhaseSpaceGrid
from .interop import from_pde_field as from_pde_field
from .interop import to_pde_field as to_pde_field
from .model.curves import Curve as Curve
from .model.curves import EllipticNozzle as EllipticNozzle
from .model.curves import FixedBelt as FixedBelt
from .model.curves import MovingBelt as MovingBelt
from .model.curves import OscillatingNozzle as OscillatingNozzle
from .model.curves import RotatingNozzle as RotatingNozzle
from .model.curves import TabulatedCurve as TabulatedCurve
from .model.laydown import LayDownModel as LayDownModel
from .model.potentials import CallablePotential as CallablePotential
from .model.potentials import FreePotential as FreePotential
from .model.potentials import IsotropicPotential as IsotropicPotential
from .model.potentials import LinearPotential as LinearPotential
from .model.potentials import Potential as Potential
from .model.potentials import PowerPotential as PowerPotential
from .model.potentials import QuadraticPotential as QuadraticPotential
from .model.process import Process as Process
from .model.smooth import SmoothLayDownModel as SmoothLayDownModel
from .pages import report as report
from .paths import Paths as Paths
from .paths import sample_paths as sample_paths
from .paths.fibres.fibre_curve import FibreCurve as FibreCurve
from .paths.fibres.fit_curve import CurveFit as CurveFit
from .paths.fibres.fit_curve import fit_curve as fit_curve
from .reduced.energy import EnergyProcess as EnergyProcess
from .reduced.hydrodynamic import HydrodynamicLimit as HydrodynamicLimit
from .reduced.hydrodynamic import OrnsteinUhlenbeckLimit as OrnsteinUhlenbeckLimit
from .results import load as load
from .results.compare import Comparison as Comparison
from .results.compare import compare as compare
from .results.rerun import rerun as rerun
from .spectral.eigen.gap import SpectralGap as SpectralGap
from .spectral.eigen.gap import spectral_gap as spectral_gap
from .spectral.eigen.optimal import OptimalNoise as OptimalNoise
from .spectral.eigen.optimal import optimal_noise as optimal_noise
from .spectral.eigen.spectrum import Spectrum as Spectrum
from .spectral.eigen.spectrum import spectrum as spectrum
from .spectral.evolution.evolution import spectral_solve as spectral_solve
from .spectral.evolution.smooth_solution import (
    SmoothSpectralSolution as SmoothSpectralSolution,
)
from .spectral.evolution.smooth_steady import (
    SmoothSpectralSteadyState as SmoothSpectralSteadyState,
)
from .spectral.evolution.solution import SpectralSolution as SpectralSolution
from .spectral.evolution.steady import SpectralSteadyState as SpectralSteadyState
from .spectral.evolution.steady import spectral_steady_state as spectral_steady_state
from .studies.fourier_grid import suggest_fourier_grid as suggest_fourier_grid
from .studies.identification.compare_models import compare_models as compare_models
from .studies.identification.comparison import (
    IdentificationComparison as IdentificationComparison,
)
from .studies.identification.identification import Identification as Identification
from .studies.identification.identify import identify as identify
from .studies.suggested_grid import suggest_grid as suggest_grid
from .web.lay_web import lay_web as lay_web
from .web.pattern import MeanPattern as MeanPattern
from .web.pattern import mean_pattern as mean_pattern
from .web.predict import predict_web as predict_web
from .web.prediction import WebPrediction as WebPrediction
from .web.spectrum import WebSpectrum as WebSpectrum
from .web.spectrum import web_spectrum as web_spectrum
from .web.stream_web import stream_web as stream_web
from .web.web import Web as Web

__version__: str
