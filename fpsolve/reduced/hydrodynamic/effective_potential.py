"""Φ = (B − v ξ₁/ε)/F: the belt is a constant force, and such a force a potential."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array
from fpsolve.grids.plane import PlaneGrid
from fpsolve.model.fibre import FibreModel, check_fibre_model
from fpsolve.model.persistence import Persistence
from fpsolve.model.potentials.at_points import value_at
from fpsolve.model.potentials.evidence import check_wells_met
from fpsolve.model.potentials.linear import LinearPotential
from fpsolve.model.potentials.partition import normalisation_of
from fpsolve.model.potentials.potential import Potential
from fpsolve.model.potentials.power import PowerPotential
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.model.potentials.wells import check_places

__all__ = ["EffectivePotential", "check_limit"]


@dataclass(frozen=True)
class EffectivePotential:
    """Φ(ξ) = (B(ξ) − A²v ξ₁)/F; the limit equation is ∂ₛ𝒫 = εF ∇·(∇ + ∇Φ)𝒫.

    Parameters
    ----------
    potential : Potential
        Buckling potential B.
    pull : float
        v/ε = A²v.
    temperature : float
        F, by which a smooth fibre diffuses faster than the basic one, at the same
        drift; 1 for the basic model.
    """

    potential: Potential
    pull: float
    temperature: float = 1.0

    def value(self, xi1: ArrayLike, xi2: ArrayLike) -> Array:
        """Φ, in the broadcast shape of the arguments."""
        tilted = self.potential.value(xi1, xi2) - np.multiply(self.pull, xi1)
        return np.asarray(tilted / self.temperature)

    def on(self, plane: PlaneGrid) -> Array:
        """Φ in the cells of a plane, finite; ValueError otherwise."""
        xi1, xi2 = plane.mesh()
        tilted = value_at(self.potential, xi1, xi2) - np.multiply(self.pull, xi1)
        return np.asarray(tilted / self.temperature)

    def gradient(self, xi1: ArrayLike, xi2: ArrayLike) -> tuple[Array, Array]:
        """∇Φ, two arrays in the broadcast shape."""
        slope1, slope2 = self.potential.gradient(xi1, xi2)
        return (slope1 - self.pull) / self.temperature, slope2 / self.temperature

    def density(self, xi1: ArrayLike, xi2: ArrayLike) -> Array:
        """exp(−Φ)/∫exp(−Φ), the stationary density of the limit.

        Raises
        ------
        ValueError
            If B has a well at one of the points that ∫exp(−B) does not count.
        """
        check_wells_met(self.potential, xi1, xi2)
        return np.asarray(np.exp(-self.value(xi1, xi2) - self.log_normalisation))

    @property
    def normalisable(self) -> bool:
        """Whether exp(−Φ) is integrable over the plane."""
        return math.isfinite(self.log_normalisation)

    @cached_property
    def log_normalisation(self) -> float:
        """ln ∫ exp(−Φ) dξ over the plane; infinite when it does not exist.

        In closed form for quadratic and linear B, and for the basic model without a
        belt; by quadrature otherwise.
        """
        if not self.pull and self.temperature == 1:
            return self.potential.log_partition_function
        if isinstance(self.potential, QuadraticPotential):
            at_rest = self.potential.log_partition_function + math.log(self.temperature)
            longer = (self.pull * self.potential.sigma1) ** 2 / self.temperature
            return at_rest + 0.5 * longer
        slope = slope_of(self.potential)
        if slope is not None:
            pull = self.pull / self.temperature
            return _log_normalisation_of_linear(slope / self.temperature, pull)
        places = check_places("well_places", self.potential.well_places)
        return normalisation_of(self.value, well_places=places).log_value


def slope_of(potential: Potential) -> float | None:
    """K of a potential that is K ‖ξ‖, otherwise None."""
    if isinstance(potential, LinearPotential):
        return potential.slope
    if isinstance(potential, PowerPotential) and potential.exponent == 1:
        return 1.0 / potential.scale
    return None


def _log_normalisation_of_linear(slope: float, pull: float) -> float:
    """ln of ∫ exp(−K‖ξ‖ + wξ₁) dξ = 2πK/(K² − w²)^{3/2}, infinite unless |w| < K."""
    if not abs(pull) < slope:
        return math.inf
    room = (slope - pull) * (slope + pull)
    return math.log(2 * math.pi * slope) - 1.5 * math.log(room)


def check_limit(model: FibreModel) -> EffectivePotential:
    """Φ of a model, if its limit exists; ValueError or TypeError otherwise."""
    check_fibre_model(model)
    if not model.noise > 0:
        raise ValueError(
            f"`noise` must be positive for the limit of large noise, got "
            f"{model.noise:g}; its small parameter is ε = 1/A². For small noise see "
            "EnergyProcess."
        )
    if not (model.curve.autonomous and moves_along_belt(model)):
        raise ValueError(
            f"`curve` must move at constant speed, got {model.curve!r}; the limit is "
            "derived for γ' = −v e₁: use FixedBelt or MovingBelt."
        )
    if not abs(model.belt_speed) < 1:
        raise ValueError(
            "`speed` must lie strictly between -1 and 1, got "
            f"{model.belt_speed:g}; a faster belt tears the fibre."
        )
    pull, temperature = model.noise**2 * model.belt_speed, Persistence.of(model).factor
    phi = EffectivePotential(model.potential, pull, temperature)
    check_confinement(model, phi)
    return phi


def moves_along_belt(model: FibreModel) -> bool:
    """Whether γ' = −v e₁ at s = 0."""
    along, across = model.curve.velocity(0.0)
    return bool(along == -model.belt_speed and across == 0)


def check_confinement(model: FibreModel, phi: EffectivePotential) -> None:
    """Raise ValueError unless exp(−Φ) is integrable."""
    if not model.potential.normalisable:
        raise ValueError(
            f"`potential` must confine, got {model.potential!r}: exp(-B) has no finite "
            "integral and the limit no stationary density; choose one that grows with "
            "the distance."
        )
    if phi.normalisable:
        return
    if not phi.pull:
        raise ValueError(
            "`relaxation_length` must be small enough for exp(-B/F) to be integrable, "
            f"F = {phi.temperature:.4g} by which a curved fibre spreads farther, got "
            f"{model.potential!r}; shorten it, or choose a potential that grows faster."
        )
    slope = slope_of(model.potential)
    limit = "" if slope is None else f", below K/A² = {slope / model.noise**2:.4g}"
    raise ValueError(
        f"`speed` must be small enough for exp(-B + A²v ξ1) to be integrable{limit}, "
        f"got {model.belt_speed:g} with A = {model.noise:g} and {model.potential!r}; "
        "slow the belt, lower the noise, or choose a potential that grows faster than "
        "linearly."
    )
