"""How well the two limits hold: orders of convergence as the noise grows or falls.

`large_noise_limit` measures the distance of the full equation to its hydrodynamic
limit, `small_noise_limit` that of the law of the energy G to the averaged equation, and
`small_noise_spectrum` compares eigenvalues; `observed_orders` and `fitted_order` say at
which power of the small parameter a distance falls. The names are loaded on first use.
"""

from fpsolve._support.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
