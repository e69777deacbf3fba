"""Questions that one call answers: do density and paths agree, do averages converge.

`cross_check` solves a model for its density, samples its paths and says whether both
agree; `compare` does so for results that exist already. `ergodic_averages` measures
how time averages converge to those of the equilibrium. `rate_versus_noise` puts decay
rates of runs, spectra and proven bounds side by side, and `sweep` runs any function
over many cases, in processes or on a cluster. The names are loaded on first use.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fpsolve.studies.agreement import AgreementTest, CrossCheck
    from fpsolve.studies.comparison import compare, cross_check
    from fpsolve.studies.ergodicity import (
        ErgodicFit,
        ergodic_averages,
        fit_ergodic_error,
    )
    from fpsolve.studies.limits.energy_sectors import small_noise_spectrum
    from fpsolve.studies.limits.large_noise import large_noise_limit
    from fpsolve.studies.limits.orders import (
        FittedOrder,
        fitted_order,
        observed_orders,
    )
    from fpsolve.studies.limits.small_noise import small_noise_limit
    from fpsolve.studies.rates.poisson import asymptotic_variances
    from fpsolve.studies.rates.rate_versus_noise import rate_versus_noise
    from fpsolve.studies.rates.sweep import Case, sweep

__all__ = [
    "AgreementTest",
    "Case",
    "CrossCheck",
    "ErgodicFit",
    "FittedOrder",
    "asymptotic_variances",
    "compare",
    "cross_check",
    "ergodic_averages",
    "fit_ergodic_error",
    "fitted_order",
    "large_noise_limit",
    "observed_orders",
    "rate_versus_noise",
    "small_noise_limit",
    "small_noise_spectrum",
    "sweep",
]

_HOME = {
    "AgreementTest": "agreement",
    "CrossCheck": "agreement",
    "compare": "comparison",
    "cross_check": "comparison",
    "ErgodicFit": "ergodicity",
    "ergodic_averages": "ergodicity",
    "fit_ergodic_error": "ergodicity",
    "FittedOrder": "limits.orders",
    "fitted_order": "limits.orders",
    "large_noise_limit": "limits.large_noise",
    "observed_orders": "limits.orders",
    "Case": "rates.sweep",
    "asymptotic_variances": "rates.poisson",
    "rate_versus_noise": "rates.rate_versus_noise",
    "small_noise_limit": "limits.small_noise",
    "small_noise_spectrum": "limits.energy_sectors",
    "sweep": "rates.sweep",
}


def __getattr__(name: str) -> Any:
    if name == "limits":
        return importlib.import_module(f"{__name__}.limits")
    if name in _HOME:
        value = getattr(importlib.import_module(f"{__name__}.{_HOME[name]}"), name)
        globals()[name] = value
        return value
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
