"""The continuous problem: a fibre laid down by a stochastic process."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array, check_numbers
from fpsolve._support.checks import check_kind
from fpsolve.model.curves.belts import FixedBelt
from fpsolve.model.curves.curve import Curve
from fpsolve.model.curves.dictionaries import curve_to_dict
from fpsolve.model.fibre import FibreModel, checked_noise
from fpsolve.model.potentials.dictionaries import potential_to_dict
from fpsolve.model.potentials.evidence import check_wells_met
from fpsolve.model.potentials.potential import Potential

__all__ = ["LayDownModel", "check_model"]


@dataclass(frozen=True)
class LayDownModel(FibreModel):
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
        self._check_parts()
        object.__setattr__(self, "noise", checked_noise(self.noise))

    @property
    def diffusivity(self) -> float:
        """Angular diffusivity A²/2."""
        return 0.5 * self.noise**2

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
        terms = f"∂ₛp + {self._transport()} - ∂_α(∇B·τ⊥ p) = {self._diffusion()}"
        return ", ".join([terms, *self._unknowns()])

    @property
    def process_equation(self) -> str:
        """The stochastic equation (6) as plain text with the actual parameters."""
        noise = f" + {self.noise:g} dW" if self.noise else ""
        angle = f"dα = -∇B(ξ)·τ⊥(α) ds{noise}"
        return ", ".join([self._motion(), angle, *self._unknowns()])

    @property
    def process_latex(self) -> tuple[str, str]:
        """The stochastic equations of ξ and of α as LaTeX."""
        noise = rf" + {self.noise:g}\,dW" if self.noise else ""
        angle = rf"d\alpha = -\nabla B(\xi)\cdot\tau^\perp(\alpha)\,ds{noise}"
        return self._motion_latex(), angle

    def to_dict(self) -> dict[str, Any]:
        """Return the model as a JSON-able dictionary.

        Of a user's own potential and curve it also says what they compute, by a digest.
        """
        return {
            "potential": potential_to_dict(self.potential),
            "noise": self.noise,
            "curve": curve_to_dict(self.curve),
        }

    def __repr__(self) -> str:
        parameters = (
            f"potential={self.potential!r}, noise={self.noise!r}, curve={self.curve!r}"
        )
        return f"LayDownModel({parameters})\n  {self.equation}"

    @property
    def latex(self) -> str:
        """The Fokker-Planck equation as LaTeX, without dollar signs and without B."""
        return (
            rf"\partial_s p + {self._transport_latex()}"
            r" - \partial_\alpha(\nabla B\cdot\tau^\perp p)"
            rf" = {self._diffusion_latex()}"
        )

    def _diffusion(self) -> str:
        return f"{self.diffusivity:g} ∂_αα p" if self.noise else "0"

    def _diffusion_latex(self) -> str:
        if not self.noise:
            return "0"
        return rf"{self.diffusivity:g}\,\partial_{{\alpha\alpha}} p"


def check_model(model: Any) -> None:
    """Raise TypeError unless `model` is a lay-down model."""
    remedy = "make one by LayDownModel(potential, noise)"
    if isinstance(model, FibreModel):
        remedy = "its `white_noise_limit` is one, for a relaxation length R → 0"
    check_kind("model", model, LayDownModel, remedy)
