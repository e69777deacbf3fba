"""Which models the expansion in Hermite polynomials solves."""

from __future__ import annotations

from fpsolve.models import LayDownModel
from fpsolve.potentials import QuadraticPotential

__all__ = ["check_model", "quadratic"]


def check_model(model: LayDownModel) -> None:
    """Raise unless the expansion solves the model."""
    if not isinstance(model, LayDownModel):
        raise TypeError(f"`model` must be a LayDownModel, got {model!r}.")
    quadratic(model)
    if not model.noise > 0:
        raise ValueError(
            "`noise` must be positive, got 0; without noise the density keeps "
            "folding and no truncation is fine enough."
        )
    if not (model.curve.autonomous and model.curve.velocity(0.0)[1] == 0):
        raise ValueError(
            "`curve` must be a belt at rest or at constant speed, got "
            f"{model.curve!r}; use `solve` for a moving nozzle."
        )


def quadratic(model: LayDownModel) -> QuadraticPotential:
    """The potential; ValueError unless it is quadratic."""
    if not isinstance(model.potential, QuadraticPotential):
        raise ValueError(
            f"`potential` must be a QuadraticPotential, got {model.potential!r}; use "
            "`solve` for others."
        )
    return model.potential
