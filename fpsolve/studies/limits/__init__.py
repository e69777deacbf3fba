"""How well the two limits hold: orders of convergence as the noise grows or falls.

`large_noise_limit` measures the distance of the full equation to its hydrodynamic
limit, `small_noise_limit` that of the law of the energy G to the averaged equation, and
`small_noise_spectrum` compares eigenvalues; `observed_orders` and `fitted_order` say at
which power of the small parameter a distance falls. The names are loaded on first use.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fpsolve.studies.limits.energy_sectors import small_noise_spectrum
    from fpsolve.studies.limits.large_noise import large_noise_limit
    from fpsolve.studies.limits.orders import (
        FittedOrder,
        fitted_order,
        observed_orders,
    )
    from fpsolve.studies.limits.small_noise import small_noise_limit

__all__ = [
    "FittedOrder",
    "fitted_order",
    "large_noise_limit",
    "observed_orders",
    "small_noise_limit",
    "small_noise_spectrum",
]

_HOME = {
    "FittedOrder": "orders",
    "fitted_order": "orders",
    "large_noise_limit": "large_noise",
    "observed_orders": "orders",
    "small_noise_limit": "small_noise",
    "small_noise_spectrum": "energy_sectors",
}


def __getattr__(name: str) -> Any:
    if name in _HOME:
        return getattr(importlib.import_module(f"{__name__}.{_HOME[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
