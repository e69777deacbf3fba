"""Which integrator takes the paths of which model."""

from __future__ import annotations

from typing import Any

from fpsolve.model.laydown import LayDownModel
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.paths.integrators import Integrator
from fpsolve.paths.smooth import SmoothIntegrator

__all__ = ["integrator_of"]

INTEGRATORS: dict[type, type[Integrator]] = {
    LayDownModel: Integrator,
    SmoothLayDownModel: SmoothIntegrator,
}


def integrator_of(model: Any) -> type[Integrator]:
    """The class of integrators for a model, or for one that is derived from it."""
    return next(
        INTEGRATORS[kind] for kind in type(model).__mro__ if kind in INTEGRATORS
    )
