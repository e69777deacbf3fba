"""The names of this package, and where each of them lives."""

from .energy_sectors import small_noise_spectrum as small_noise_spectrum
from .large_noise import large_noise_limit as large_noise_limit
from .orders import FittedOrder as FittedOrder
from .orders import fitted_order as fitted_order
from .orders import observed_orders as observed_orders
from .small_noise import small_noise_limit as small_noise_limit
from .white_noise import white_noise_limit as white_noise_limit
