"""The continuous problem of a smooth fibre: its curvature relaxes to the force."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fpsolve._support.arrays import check_numbers
from fpsolve._support.checks import check_non_negative, check_positive
from fpsolve.model.curves.belts import FixedBelt
from fpsolve.model.curves.curve import Curve
from fpsolve.model.curves.dictionaries import curve_to_dict
from fpsolve.model.fibre import FibreModel, checked_noise
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.dictionaries import potential_to_dict
from fpsolve.model.potentials.potential import Potential

__all__ = ["SmoothLayDownModel"]

# The fourth power of K = A/R is a number.
_SHORTEST, _LONGEST = 1e-15, 1e15


@dataclass(frozen=True, init=False)
class SmoothLayDownModel(FibreModel):
    """∂ₛp + (τ - γ')·∇p + κ ∂_α p - ∂_κ((κ + ∇B·τ⊥) p)/R = (K²/2) ∂_κκ p.

    The Fokker-Planck equation (23) of the improved, smooth lay-down model (22),
    dξ = τ(α) ds - dγ, dα = κ ds, dκ = -(κ + ∇B(ξ)·τ⊥(α))/R ds + K dW: the fibre has a
    tangent that is differentiable, and its curvature κ relaxes over the length R to the
    turn that the potential asks for. For R → 0 at fixed A = RK it becomes the basic
    model with the noise A, see `white_noise_limit`.

    On a fixed belt exp(-B) times a Gaussian in κ is *not* stationary, in contrast to
    the basic model, whose p_S of (10) is: this model has no density of a closed form.
    Without a potential κ is stationary with variance K²R/2 = A²/(2R).

    Everything is dimensionless; `fpsolve.Process` translates from SI units.

    Parameters
    ----------
    potential : Potential
        Buckling potential B.
    relaxation_length : float
        R, between 1e-15 and 1e15.
    noise : float, optional
        Noise amplitude A = RK of the angle: 0, or between 1e-60 and 1e60.
    curve : Curve, optional
        Reference curve γ; a fixed belt by default.
    curvature_noise : float, optional
        Noise amplitude K of the curvature, in place of A. What is kept is A.

    Raises
    ------
    ValueError
        If the relaxation length is not positive, the noise negative, one of them not
        finite or so extreme that its powers are, or if a user's class of potentials has
        a gradient that is not that of its value.
    TypeError
        If both or neither of `noise` and `curvature_noise` are given, or an argument is
        of another kind.

    References
    ----------
    [KMW09]_, section 3.2, equations (22) and (23).
    """

    potential: Potential
    relaxation_length: float
    noise: float
    curve: Curve

    def __init__(
        self,
        potential: Potential,
        relaxation_length: float,
        noise: float | None = None,
        curve: Curve | None = None,
        *,
        curvature_noise: float | None = None,
    ) -> None:
        length = check_relaxation_length(relaxation_length)
        values = {
            "potential": potential,
            "relaxation_length": length,
            "noise": _noise_of_angle(length, noise, curvature_noise),
            "curve": FixedBelt() if curve is None else curve,
        }
        for name, value in values.items():
            object.__setattr__(self, name, value)
        self._check_parts()

    @property
    def curvature_noise(self) -> float:
        """Noise amplitude K = A/R of the curvature."""
        return self.noise / self.relaxation_length

    @property
    def curvature_variance(self) -> float:
        """K²R/2 = A²/(2R): the variance of κ where no force turns the fibre."""
        return 0.5 * self.noise**2 / self.relaxation_length

    @property
    def has_equilibrium(self) -> bool:
        """False: no density in closed form is stationary, exp(-B) p(κ) least of all."""
        return False

    @property
    def white_noise_limit(self) -> LayDownModel:
        """The basic model with A = RK, to which this one tends for R → 0."""
        return LayDownModel(self.potential, self.noise, self.curve)

    def drift(
        self,
        xi1: ArrayLike,
        xi2: ArrayLike,
        alpha: ArrayLike,
        kappa: ArrayLike,
        s: float = 0.0,
    ) -> tuple[NDArray[np.float64], ...]:
        """(cos α - γ1', sin α - γ2', κ, -(κ + ∇B·τ⊥)/R): the drift of (ξ, α, κ).

        Parameters
        ----------
        xi1, xi2, alpha, kappa : array_like
            Coordinates that broadcast against each other; α in radians.
        s : float, optional
            Arclength; matters only when the curve is not autonomous.

        Returns
        -------
        tuple of ndarray
            Four, each in the shape of what it depends on.
        """
        kappa = check_numbers("kappa", kappa)
        motion1, motion2, turn = self.white_noise_limit.drift(xi1, xi2, alpha, s)
        return motion1, motion2, kappa, (turn - kappa) / self.relaxation_length

    @property
    def equation(self) -> str:
        """The Fokker-Planck equation as plain text with the actual parameters."""
        force = f"∂_κ((κ + ∇B·τ⊥) p){self._divided}"
        diffusivity = 0.5 * self.curvature_noise**2
        diffusion = f"{diffusivity:g} ∂_κκ p" if self.noise else "0"
        terms = f"∂ₛp + {self._transport()} + κ ∂_α p - {force} = {diffusion}"
        return ", ".join([terms, *self._unknowns()])

    @property
    def process_equation(self) -> str:
        """The stochastic equation (22) as plain text with the actual parameters."""
        noise = f" + {self.curvature_noise:g} dW" if self.noise else ""
        force = f"dκ = -(κ + ∇B(ξ)·τ⊥(α)){self._divided} ds{noise}"
        return ", ".join([self._motion(), "dα = κ ds", force, *self._unknowns()])

    @property
    def latex(self) -> str:
        """The Fokker-Planck equation as LaTeX, without dollar signs and without B."""
        diffusivity = 0.5 * self.curvature_noise**2
        diffusion = rf"{diffusivity:g}\,\partial_{{\kappa\kappa}} p"
        return (
            rf"\partial_s p + {self._transport_latex()} + \kappa\,\partial_\alpha p"
            r" - \partial_\kappa((\kappa + \nabla B\cdot\tau^\perp) p)"
            rf"{self._divided} = {diffusion if self.noise else '0'}"
        )

    @property
    def process_latex(self) -> tuple[str, str, str]:
        """The stochastic equations of ξ, α and κ as LaTeX."""
        noise = rf" + {self.curvature_noise:g}\,dW" if self.noise else ""
        force = r"(\kappa + \nabla B(\xi)\cdot\tau^\perp(\alpha))"
        curvature = rf"d\kappa = -{force}{self._divided}\,ds{noise}"
        return self._motion_latex(), r"d\alpha = \kappa\,ds", curvature

    def to_dict(self) -> dict[str, Any]:
        """Return the model as a JSON-able dictionary.

        Of a user's own potential and curve it also says what they compute, by a digest.
        """
        return {
            "potential": potential_to_dict(self.potential),
            "relaxation_length": self.relaxation_length,
            "noise": self.noise,
            "curve": curve_to_dict(self.curve),
        }

    def __repr__(self) -> str:
        parameters = (
            f"potential={self.potential!r}, "
            f"relaxation_length={self.relaxation_length!r}, noise={self.noise!r}, "
            f"curve={self.curve!r}"
        )
        return f"SmoothLayDownModel({parameters})\n  {self.equation}"

    @property
    def _divided(self) -> str:
        """What divides the force, /R, or nothing where R = 1."""
        length = self.relaxation_length
        return "" if length == 1 else f"/{length:g}"


def check_relaxation_length(value: Any) -> float:
    """Return R as a float; ValueError unless it and the powers of it are numbers."""
    length = check_positive(
        "relaxation_length",
        value,
        "; without one the model is the basic one, LayDownModel",
    )
    if not _SHORTEST <= length <= _LONGEST:
        raise ValueError(
            f"`relaxation_length` must lie between {_SHORTEST:g} and {_LONGEST:g}, got "
            f"{length:g}; a shorter one is the basic model, LayDownModel."
        )
    return length


def _noise_of_angle(length: float, noise: Any, curvature_noise: Any) -> float:
    """A = RK, from the one of both that is given."""
    if (noise is None) == (curvature_noise is None):
        given = "neither" if noise is None else "both"
        raise TypeError(
            "exactly one of `noise` and `curvature_noise` must be given, got "
            f"{given}; pass A = RK as `noise`, or K as `curvature_noise`."
        )
    if noise is None:
        noise = length * check_non_negative("curvature_noise", curvature_noise)
    return checked_noise(noise)
