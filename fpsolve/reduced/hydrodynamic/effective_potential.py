"""Φ = B − v ξ₁/ε: the belt is a constant force, and a constant force a potential."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array
from fpsolve.grids.plane import PlaneGrid
from fpsolve.model.laydown import LayDownModel, check_model
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
    """Φ(ξ) = B(ξ) − A²v ξ₁; the limit equation is ∂ₛ𝒫 = ε∇·(∇ + ∇Φ)𝒫.

    Parameters
    ----------
    potential : Potential
        Buckling potential B.
    pull : float
        v/ε = A²v.
    """

    potential: Potential
    pull: float

    def value(self, xi1: ArrayLike, xi2: ArrayLike) -> Array:
        """Φ, in the broadcast shape of the arguments."""
        return np.asarray(self.potential.value(xi1, xi2) - np.multiply(self.pull, xi1))

    def on(self, plane: PlaneGrid) -> Array:
        """Φ in the cells of a plane, finite; ValueError otherwise."""
        xi1, xi2 = plane.mesh()
        return value_at(self.potential, xi1, xi2) - np.multiply(self.pull, xi1)

    def gradient(self, xi1: ArrayLike, xi2: ArrayLike) -> tuple[Array, Array]:
        """∇Φ, two arrays in the broadcast shape."""
        slope1, slope2 = self.potential.gradient(xi1, xi2)
        return slope1 - self.pull, slope2

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

        In closed form for quadratic and linear B and without a belt, by quadrature
        otherwise.
        """
        at_rest = self.potential.log_partition_function
        if not self.pull:
            return at_rest
        if isinstance(self.potential, QuadraticPotential):
            return at_rest + 0.5 * (self.pull * self.potential.sigma1) ** 2
        slope = slope_of(self.potential)
        if slope is not None:
            return _log_normalisation_of_linear(slope, self.pull)
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


def check_limit(model: LayDownModel) -> EffectivePotential:
    """Φ of a model, if its limit exists; ValueError or TypeError otherwise."""
    check_model(model)
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
    phi = EffectivePotential(model.potential, model.noise**2 * model.belt_speed)
    check_confinement(model, phi)
    return phi


def moves_along_belt(model: LayDownModel) -> bool:
    """Whether γ' = −v e₁ at s = 0."""
    along, across = model.curve.velocity(0.0)
    return bool(along == -model.belt_speed and across == 0)


def check_confinement(model: LayDownModel, phi: EffectivePotential) -> None:
    """Raise ValueError unless exp(−B + A²v ξ₁) is integrable."""
    if not model.potential.normalisable:
        raise ValueError(
            f"`potential` must confine, got {model.potential!r}: exp(-B) has no finite "
            "integral and the limit no stationary density; choose one that grows with "
            "the distance."
        )
    if phi.normalisable:
        return
    slope = slope_of(model.potential)
    limit = "" if slope is None else f", below K/A² = {slope / model.noise**2:.4g}"
    raise ValueError(
        f"`speed` must be small enough for exp(-B + A²v ξ1) to be integrable{limit}, "
        f"got {model.belt_speed:g} with A = {model.noise:g} and {model.potential!r}; "
        "slow the belt, lower the noise, or choose a potential that grows faster than "
        "linearly."
    )
