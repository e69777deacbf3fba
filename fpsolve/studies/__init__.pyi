"""The names of this package, and where each of them lives."""

from . import limits as limits
from .agreement.check import CrossCheck as CrossCheck
from .agreement.compare import compare as compare
from .agreement.cross_check import cross_check as cross_check
from .agreement.outcome import AgreementTest as AgreementTest
from .constants.relaxation_slopes import Slope as Slope
from .constants.relaxation_slopes import gap_slope as gap_slope
from .constants.relaxation_slopes import variance_slope as variance_slope
from .design.design_web import design_web as design_web
from .design.result import WebDesign as WebDesign
from .ergodicity.averages import ErgodicFit as ErgodicFit
from .ergodicity.averages import ergodic_averages as ergodic_averages
from .ergodicity.averages import fit_ergodic_error as fit_ergodic_error
from .limits.energy_sectors import small_noise_spectrum as small_noise_spectrum
from .limits.large_noise import large_noise_limit as large_noise_limit
from .limits.orders import FittedOrder as FittedOrder
from .limits.orders import fitted_order as fitted_order
from .limits.orders import observed_orders as observed_orders
from .limits.small_noise import small_noise_limit as small_noise_limit
from .limits.white_noise import white_noise_limit as white_noise_limit
from .rates.poisson import asymptotic_variances as asymptotic_variances
from .rates.rate_versus_noise import rate_versus_noise as rate_versus_noise
from .sweeps.sweep import Case as Case
from .sweeps.sweep import sweep as sweep
from .webs.homogeneity import web_homogeneity as web_homogeneity
