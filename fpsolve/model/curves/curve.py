"""What every reference curve offers."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import fields
from typing import Any, ClassVar

from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_finite

__all__ = ["Curve", "check_speed"]


class Curve(ABC):
    """A reference curve γ(s) in the plane, differentiable in the arclength s.

    It enters the model through dξ = τ(α) ds - dγ, equation (6). Everything is
    dimensionless; positions are in units of the throwing range σ1.

    A new curve is a frozen dataclass with a field `speed` that defines the methods
    below, and `kind` if it is to be stored.

    Attributes
    ----------
    speed : float
        Belt speed v: the curve moves by -v e1 per unit of arclength on average.

    References
    ----------
    [KMW09]_, sections 3.1 and 4.2.
    """

    kind: ClassVar[str] = "custom"

    speed: float

    @abstractmethod
    def position(self, s: ArrayLike) -> tuple[Array, Array]:
        """(γ1(s), γ2(s)), each in the shape of s."""

    @abstractmethod
    def velocity(self, s: ArrayLike) -> tuple[Array, Array]:
        """(γ1'(s), γ2'(s)), each in the shape of s."""

    @abstractmethod
    def displacement(self, s0: float, s1: float) -> tuple[float, float]:
        """γ(s1) - γ(s0), without the cancellation of two large positions."""

    def check_span(self, start: float, end: float) -> None:  # noqa: B027
        """Raise ValueError unless γ is known from start to end; it always is here.

        Called before every run. A curve that has an end says so.
        """

    @property
    @abstractmethod
    def autonomous(self) -> bool:
        """Whether γ' does not depend on s."""

    @property
    @abstractmethod
    def fixed(self) -> bool:
        """Whether γ' = 0, so that p_S is stationary."""

    @property
    @abstractmethod
    def formula(self) -> str:
        """γ(s) as plain text with the actual parameters."""

    @property
    @abstractmethod
    def latex(self) -> str:
        """γ(s) as LaTeX with the actual parameters, without dollar signs."""

    def to_dict(self) -> dict[str, Any]:
        """Return `kind` and the parameters as a JSON-able dictionary."""
        parameters = {
            field.name: getattr(self, field.name)
            for field in fields(self)  # type: ignore[arg-type]
            if field.init
        }
        return {"kind": self.kind, **parameters}

    def _repr_latex_(self) -> str:
        return f"$\\gamma(s) = {self.latex}$"


def check_speed(name: str, speed: Any) -> float:
    """Return the belt speed as a float; ValueError unless -1 < v < 1."""
    number = check_finite(name, speed)
    if not abs(number) < 1:
        raise ValueError(
            f"`{name}` must lie strictly between -1 and 1, got {number:g}; E cos α = "
            "-v in the stationary state, so a faster belt tears the fibre."
        )
    return number
