"""The continuous problem: a fibre laid down by a stochastic process."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array, check_numbers
from fpsolve._support.checks import (
    check_kind,
    check_noise,
    check_non_negative,
    construct,
    shown,
)
from fpsolve.model.curves.belts import FixedBelt
from fpsolve.model.curves.curve import Curve
from fpsolve.model.curves.dictionaries import curve_from_dict, curve_to_dict
from fpsolve.model.potentials.claims import check_gradient
from fpsolve.model.potentials.dictionaries import potential_from_dict, potential_to_dict
from fpsolve.model.potentials.evidence import check_wells_met
from fpsolve.model.potentials.potential import Potential

__all__ = ["LayDownModel", "check_model"]


@dataclass(frozen=True)
class LayDownModel:
    """∂ₛp + (τ(α) - γ'(s))·∇p - ∂_α(∇B·τ⊥ p) = (A²/2) ∂_αα p.

    The Fokker-Planck equation of the basic lay-down model
    dξ = τ(α) ds - dγ, dα = -∇B(ξ)·τ⊥(α) ds + A dW, with τ = (cos α, sin α) and
    τ⊥ = (-sin α, cos α). The paper prints +dγ/ds in (7); the process (6) and the
    belt form (17) require the minus sign used here. Mass is conserved, and on a fixed
    belt the density p_S = exp(-B)/(2π Z) is stationary for every noise.

    Everything is dimensionless; `fpsolve.process` translates from SI units.

    Parameters
    ----------
    potential : Potential
        Buckling potential B.
    noise : float
        Noise amplitude A: 0, or between 1e-60 and 1e60.
    curve : Curve, optional
        Reference curve γ; a fixed belt by default.

    Raises
    ------
    ValueError
        If the noise is negative, not finite, or so extreme that its powers are, or if
        a user's class of potentials has a gradient that is not that of its value.
    TypeError
        If an argument is of another kind.

    References
    ----------
    [KMW09]_, section 3.1, equations (6), (7), (9) and (10).
    """

    potential: Potential
    noise: float
    curve: Curve = field(default_factory=FixedBelt)

    def __post_init__(self) -> None:
        if not isinstance(self.potential, Potential):
            raise TypeError(
                f"`potential` must be a Potential, got {shown(self.potential)}; wrap "
                "functions in CallablePotential."
            )
        if not isinstance(self.curve, Curve):
            raise TypeError(
                f"`curve` must be a Curve, got {shown(self.curve)}; use "
                "MovingBelt(speed) for a moving belt."
            )
        noise = check_non_negative("noise", self.noise)
        if noise:
            noise = check_noise("noise", noise)
        object.__setattr__(self, "noise", noise)
        if not self.potential.of_fpsolve:
            check_gradient(self.potential.value, self.potential.gradient)

    @property
    def diffusivity(self) -> float:
        """Angular diffusivity A²/2."""
        return 0.5 * self.noise**2

    @property
    def belt_speed(self) -> float:
        """Belt speed v, the mean of -γ1'."""
        return self.curve.speed

    @property
    def has_equilibrium(self) -> bool:
        """Whether p_S of (10) exists and is stationary: γ' = 0 and Z finite."""
        return self.curve.fixed and self.potential.normalisable

    def drift(
        self, xi1: ArrayLike, xi2: ArrayLike, alpha: ArrayLike, s: float = 0.0
    ) -> tuple[Array, Array, Array]:
        """(cos α - γ1', sin α - γ2', -∇B·τ⊥): the drift of (ξ, α) per unit of s.

        Parameters
        ----------
        xi1, xi2, alpha : array_like
            Coordinates that broadcast against each other; α in radians.
        s : float, optional
            Arclength; matters only when the curve is not autonomous.

        Returns
        -------
        tuple of ndarray
            The first two in the shape of `alpha`, on which alone they depend, the
            third in the broadcast shape of all coordinates.
        """
        alpha = check_numbers("alpha", alpha)
        cosine, sine = np.cos(alpha), np.sin(alpha)
        slope1, slope2 = self.potential.gradient(xi1, xi2)
        curve1, curve2 = self.curve.velocity(s)
        return cosine - curve1, sine - curve2, slope1 * sine - slope2 * cosine

    def equilibrium(self, xi1: ArrayLike, xi2: ArrayLike) -> Array:
        """p_S(ξ) = exp(-B(ξ))/(2π Z), normalised on R² x [0, 2π).

        It does not depend on α or on the noise. Stationary only on a fixed belt; on a
        moving one it is still the reference density of the relative entropy (11).

        Raises
        ------
        ValueError
            If exp(-B) is not integrable, or B has a well at one of the points that Z
            does not count.

        References
        ----------
        [KMW09]_, equation (10).
        """
        if not self.potential.normalisable:
            raise ValueError(
                "`potential` must be normalisable to have an equilibrium, got "
                f"{self.potential!r}; choose one that grows with the distance."
            )
        normalisation = self.potential.normalisation
        # Both parts of Z at once would overflow where B is far below zero.
        value = self.potential.value(xi1, xi2)
        check_wells_met(self.potential, xi1, xi2, value)
        weight = np.exp(normalisation.lowest - value)
        return np.asarray(weight / (2 * math.pi * normalisation.integral))

    @property
    def equation(self) -> str:
        """The Fokker-Planck equation as plain text with the actual parameters."""
        velocity = self._velocity("τ(α)", "γ'(s)", " e₁")
        diffusion = f"{self.diffusivity:g} ∂_αα p" if self.noise else "0"
        terms = f"∂ₛp + {velocity}·∇p - ∂_α(∇B·τ⊥ p) = {diffusion}"
        unknowns = [f"B = {self.potential.formula}"]
        if not self.curve.autonomous:
            unknowns.append(f"γ(s) = {self.curve.formula}")
        return f"{terms}, {', '.join(unknowns)}"

    @property
    def process_equation(self) -> str:
        """The stochastic equation (6) as plain text with the actual parameters."""
        curve = self.curve
        motion = "τ(α) ds - dγ"
        if curve.fixed:
            motion = "τ(α) ds"
        elif curve.autonomous:
            motion = f"(τ(α) {_signed(curve.speed)} e₁) ds"
        noise = f" + {self.noise:g} dW" if self.noise else ""
        terms = [
            f"dξ = {motion}",
            f"dα = -∇B(ξ)·τ⊥(α) ds{noise}",
            f"B = {self.potential.formula}",
        ]
        if not curve.autonomous:
            terms.append(f"γ(s) = {curve.formula}")
        return ", ".join(terms)

    def to_dict(self) -> dict[str, Any]:
        """Return the model as a JSON-able dictionary.

        Of a user's own potential and curve it also says what they compute, by a digest.
        """
        return {
            "potential": potential_to_dict(self.potential),
            "noise": self.noise,
            "curve": curve_to_dict(self.curve),
        }

    @classmethod
    def from_dict(cls, description: Mapping[str, Any]) -> LayDownModel:
        """Return the model that `to_dict` described.

        Raises
        ------
        ValueError
            If a kind or a parameter is unknown, or potential or curve are a user's own.
        """
        readers = {"potential": potential_from_dict, "curve": curve_from_dict}
        parameters = {
            name: readers[name](entry) if name in readers else entry
            for name, entry in description.items()
        }
        return construct(cls, "model", parameters)

    def __repr__(self) -> str:
        parameters = (
            f"potential={self.potential!r}, noise={self.noise!r}, curve={self.curve!r}"
        )
        return f"LayDownModel({parameters})\n  {self.equation}"

    @property
    def latex(self) -> str:
        """The Fokker-Planck equation as LaTeX, without dollar signs and without B."""
        velocity = self._velocity(r"\tau(\alpha)", r"\gamma'(s)", r"\,e_1")
        second = r"\,\partial_{\alpha\alpha} p"
        diffusion = f"{self.diffusivity:g}{second}" if self.noise else "0"
        return (
            rf"\partial_s p + {velocity}\cdot\nabla_\xi p"
            rf" - \partial_\alpha(\nabla B\cdot\tau^\perp p) = {diffusion}"
        )

    def _repr_latex_(self) -> str:
        unknowns = rf",\qquad B(\xi) = {self.potential.latex}"
        if not self.curve.autonomous:
            unknowns += rf",\quad \gamma(s) = {self.curve.latex}"
        return f"${self.latex}{unknowns}$"

    def _velocity(self, tau: str, slope: str, belt: str) -> str:
        """τ - γ' in the signs of plain text or of LaTeX."""
        if self.curve.fixed:
            return tau
        if not self.curve.autonomous:
            return f"({tau} - {slope})"
        return f"({tau} {_signed(self.belt_speed)}{belt})"


def check_model(model: Any) -> None:
    """Raise TypeError unless `model` is a lay-down model."""
    check_kind(
        "model", model, LayDownModel, "make one by LayDownModel(potential, noise)"
    )


def _signed(number: float) -> str:
    return f"{'-' if number < 0 else '+'} {abs(number):g}"
