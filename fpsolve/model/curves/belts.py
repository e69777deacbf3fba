"""Curves of constant velocity: the belt at rest and the belt in motion."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array, check_finite_numbers
from fpsolve._support.checks import check_finite, keep_checked
from fpsolve.model.curves.curve import Curve, check_speed

__all__ = ["FixedBelt", "MovingBelt"]


@dataclass(frozen=True)
class FixedBelt(Curve):
    """γ(s) = 0: a belt at rest under a nozzle at rest.

    The density p_S = c exp(-B) is stationary for every noise.

    References
    ----------
    [KMW09]_, section 3.1.1.
    """

    speed: float = field(default=0.0, init=False, repr=False)

    kind: ClassVar[str] = "fixed_belt"
    autonomous = fixed = True
    formula = latex = "0"

    def position(self, s: ArrayLike) -> tuple[Array, Array]:
        """(0, 0)."""
        shape = check_finite_numbers("s", s).shape
        return np.zeros(shape), np.zeros(shape)

    def velocity(self, s: ArrayLike) -> tuple[Array, Array]:
        """(0, 0)."""
        shape = check_finite_numbers("s", s).shape
        return np.zeros(shape), np.zeros(shape)

    def displacement(self, s0: float, s1: float) -> tuple[float, float]:
        """(0, 0)."""
        check_finite("s0", s0), check_finite("s1", s1)
        return 0.0, 0.0


@dataclass(frozen=True)
class MovingBelt(Curve):
    """γ(s) = -v s e1: a belt moving in direction e1 under a nozzle at rest.

    Parameters
    ----------
    speed : float
        Belt speed v relative to the spinning speed, -1 < v < 1.

    Raises
    ------
    ValueError
        Unless -1 < v < 1: E cos α = -v in the stationary state.

    References
    ----------
    [KMW09]_, section 3.1.
    """

    speed: float

    kind: ClassVar[str] = "moving_belt"
    autonomous = True

    def __post_init__(self) -> None:
        keep_checked(self, check_speed, "speed")

    def position(self, s: ArrayLike) -> tuple[Array, Array]:
        """(-v s, 0)."""
        s = check_finite_numbers("s", s)
        return np.asarray(-self.speed * s), np.zeros(s.shape)

    def velocity(self, s: ArrayLike) -> tuple[Array, Array]:
        """(-v, 0)."""
        shape = check_finite_numbers("s", s).shape
        return np.full(shape, -self.speed), np.zeros(shape)

    def displacement(self, s0: float, s1: float) -> tuple[float, float]:
        """(-v (s1 - s0), 0)."""
        s0, s1 = check_finite("s0", s0), check_finite("s1", s1)
        return -self.speed * (s1 - s0), 0.0

    @property
    def fixed(self) -> bool:
        """Whether v = 0."""
        return self.speed == 0

    @property
    def formula(self) -> str:
        """γ(s) as plain text."""
        return f"{-self.speed:g} s e₁" if self.speed else "0"

    @property
    def latex(self) -> str:
        """γ(s) as LaTeX."""
        return rf"{-self.speed:g}\,s\,e_1" if self.speed else "0"
