"""What lay-down models share: a potential, a reference curve, and dξ = τ ds - dγ."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, Self

from fpsolve._support.checks import (
    check_noise,
    check_non_negative,
    construct,
    shown,
)
from fpsolve.model.curves.curve import Curve
from fpsolve.model.curves.dictionaries import curve_from_dict
from fpsolve.model.potentials.claims import check_gradient
from fpsolve.model.potentials.dictionaries import potential_from_dict
from fpsolve.model.potentials.potential import Potential

__all__ = ["FibreModel", "check_fibre_model", "checked_noise"]


class FibreModel(ABC):
    """dξ = τ(α) ds - dγ: a fibre of unit speed about its reference curve.

    What turns the angle α is for the classes derived from it to say: `LayDownModel`
    and `SmoothLayDownModel`.

    Attributes
    ----------
    potential : Potential
    noise : float
    curve : Curve
    """

    potential: Potential
    noise: float
    curve: Curve

    @property
    def belt_speed(self) -> float:
        """Belt speed v, the mean of -γ1'."""
        return self.curve.speed

    @property
    @abstractmethod
    def equation(self) -> str:
        """The Fokker-Planck equation as plain text with the actual parameters."""

    @property
    @abstractmethod
    def process_equation(self) -> str:
        """The stochastic equations as plain text with the actual parameters."""

    @property
    @abstractmethod
    def latex(self) -> str:
        """The Fokker-Planck equation as LaTeX, without dollar signs and without B."""

    @property
    @abstractmethod
    def process_latex(self) -> tuple[str, ...]:
        """The stochastic equations as LaTeX, one of each coordinate."""

    @abstractmethod
    def to_dict(self) -> dict[str, Any]:
        """Return the model as a JSON-able dictionary."""

    def _check_parts(self) -> None:
        """Raise unless potential and curve are what their names say."""
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
        if not self.potential.of_fpsolve:
            check_gradient(self.potential.value, self.potential.gradient)

    def _unknowns(self) -> list[str]:
        """B and γ as the equations leave them open."""
        unknowns = [f"B = {self.potential.formula}"]
        if not self.curve.autonomous:
            unknowns.append(f"γ(s) = {self.curve.formula}")
        return unknowns

    def _motion(self) -> str:
        if self.curve.fixed:
            return "dξ = τ(α) ds"
        if not self.curve.autonomous:
            return "dξ = τ(α) ds - dγ"
        return f"dξ = (τ(α) {_signed(self.belt_speed)} e₁) ds"

    def _motion_latex(self) -> str:
        if self.curve.fixed:
            return r"d\xi = \tau(\alpha)\,ds"
        if not self.curve.autonomous:
            return r"d\xi = \tau(\alpha)\,ds - d\gamma"
        return rf"d\xi = (\tau(\alpha) {_signed(self.belt_speed)}\,e_1)\,ds"

    def _transport(self) -> str:
        if self.curve.fixed:
            return "τ(α)·∇p"
        if not self.curve.autonomous:
            return "(τ(α) - γ'(s))·∇p"
        return f"(τ(α) {_signed(self.belt_speed)} e₁)·∇p"

    def _transport_latex(self) -> str:
        if self.curve.fixed:
            return r"\tau(\alpha)\cdot\nabla_\xi p"
        if not self.curve.autonomous:
            return r"(\tau(\alpha) - \gamma'(s))\cdot\nabla_\xi p"
        return rf"(\tau(\alpha) {_signed(self.belt_speed)}\,e_1)\cdot\nabla_\xi p"

    def _repr_latex_(self) -> str:
        unknowns = rf",\qquad B(\xi) = {self.potential.latex}"
        if not self.curve.autonomous:
            unknowns += rf",\quad \gamma(s) = {self.curve.latex}"
        return f"${self.latex}{unknowns}$"

    @classmethod
    def from_dict(cls, description: Mapping[str, Any]) -> Self:
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


def checked_noise(value: Any) -> float:
    """Return the noise A as a float: zero, or such that its powers are numbers."""
    noise = check_non_negative("noise", value)
    return check_noise("noise", noise) if noise else noise


def check_fibre_model(model: Any) -> None:
    """Raise TypeError unless `model` is a lay-down model, basic or smooth."""
    if not isinstance(model, FibreModel):
        raise TypeError(
            "`model` must be a LayDownModel or a SmoothLayDownModel, got "
            f"{shown(model)}; make one by LayDownModel(potential, noise)."
        )


def _signed(number: float) -> str:
    """The number with its sign set apart, as a term of a sum."""
    return f"{'-' if number < 0 else '+'} {abs(number):g}"
