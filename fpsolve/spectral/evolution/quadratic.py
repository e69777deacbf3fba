"""Which models the expansion in Hermite polynomials solves."""

from __future__ import annotations

from typing import Any

from fpsolve._support.checks import check_positive
from fpsolve.model import laydown
from fpsolve.model.fibre import FibreModel
from fpsolve.model.potentials.quadratic import QuadraticPotential

__all__ = [
    "check_model",
    "check_noise_and_belt",
    "check_parts",
    "checked_tolerance",
    "quadratic",
]


def check_model(model: Any) -> None:
    """Raise unless the expansion solves the model."""
    laydown.check_model(model)
    check_parts(model)


def check_parts(model: FibreModel) -> None:
    """ValueError unless the expansion solves for this potential, noise and curve."""
    quadratic(model)
    check_noise_and_belt(model)


def check_noise_and_belt(model: FibreModel) -> None:
    """ValueError without noise, or under a nozzle that moves."""
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


def checked_tolerance(tolerance: Any) -> float:
    """The tolerance as a float; ValueError unless it is positive and at most 1."""
    checked = check_positive("tolerance", tolerance)
    if not checked <= 1:
        raise ValueError(
            f"`tolerance` must be at most 1, got {checked:g}; numbers above one are "
            "compared relative to themselves."
        )
    return checked


def quadratic(model: FibreModel) -> QuadraticPotential:
    """The potential; ValueError unless it is quadratic."""
    if not isinstance(model.potential, QuadraticPotential):
        raise ValueError(
            f"`potential` must be a QuadraticPotential, got {model.potential!r}; use "
            "`solve` for others."
        )
    return model.potential
