"""Nozzles that circle or swing above a moving belt."""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fpsolve._support.arrays import check_finite_numbers
from fpsolve._support.checks import check_finite, check_non_negative
from fpsolve.model.curves.curve import Curve, check_speed

__all__ = ["EllipticNozzle", "OscillatingNozzle", "RotatingNozzle"]


class _Nozzle(Curve):
    """γ(s) = -v s e1 + (r1 cos(ωs + φ), r2 sin(ωs + φ)) with radii from a subclass."""

    angular_speed: float
    phase: float

    @property
    @abstractmethod
    def radii(self) -> tuple[float, float]:
        """Radii (r1, r2) along and across the belt."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "speed", check_speed(self.speed))
        angular_speed = check_finite("angular_speed", self.angular_speed)
        object.__setattr__(self, "angular_speed", angular_speed)
        object.__setattr__(self, "phase", check_finite("phase", self.phase))

    def position(self, s: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """-v s e1 + (r1 cos(ωs + φ), r2 sin(ωs + φ))."""
        (radius1, radius2), angle = self.radii, self._angle(s)
        along = radius1 * np.cos(angle) - self.speed * check_finite_numbers("s", s)
        return np.asarray(along), np.asarray(radius2 * np.sin(angle))

    def velocity(self, s: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """-v e1 + ω (-r1 sin(ωs + φ), r2 cos(ωs + φ))."""
        (radius1, radius2), angle = self.radii, self._angle(s)
        along = -self.speed - self.angular_speed * radius1 * np.sin(angle)
        across = self.angular_speed * radius2 * np.cos(angle)
        return np.asarray(along), np.asarray(across)

    def displacement(self, s0: float, s1: float) -> tuple[float, float]:
        """γ(s1) - γ(s0), by the sum formulas of sine and cosine."""
        radius1, radius2 = self.radii
        s0, s1 = check_finite("s0", s0), check_finite("s1", s1)
        middle = self.angular_speed * 0.5 * (s0 + s1) + self.phase
        chord = 2 * math.sin(0.5 * self.angular_speed * (s1 - s0))
        along = -self.speed * (s1 - s0) - radius1 * chord * math.sin(middle)
        return along, radius2 * chord * math.cos(middle)

    @property
    def autonomous(self) -> bool:
        """Whether the nozzle is at rest, so that only the belt moves."""
        return self.angular_speed == 0 or self.radii == (0, 0)

    @property
    def fixed(self) -> bool:
        """Whether neither the nozzle nor the belt moves."""
        return self.autonomous and self.speed == 0

    @property
    def formula(self) -> str:
        """γ(s) as plain text."""
        radius1, radius2 = self.radii
        angle = f"({self._angle_text()})"
        along, across = _times(radius1, " cos", angle), _times(radius2, " sin", angle)
        belt = f"{-self.speed:g} s e₁ + " if self.speed else ""
        return f"{belt}({along}, {across})"

    @property
    def latex(self) -> str:
        """γ(s) as LaTeX."""
        radius1, radius2 = self.radii
        angle = f"({self._angle_text()})"
        along, across = _times(radius1, r"\cos", angle), _times(radius2, r"\sin", angle)
        belt = rf"{-self.speed:g}\,s\,e_1 + " if self.speed else ""
        return rf"{belt}({along},\ {across})"

    def _angle_text(self) -> str:
        if self.phase == 0:
            return f"{self.angular_speed:g} s"
        sign = "-" if self.phase < 0 else "+"
        return f"{self.angular_speed:g} s {sign} {abs(self.phase):g}"

    def _angle(self, s: ArrayLike) -> NDArray[np.float64]:
        return self.angular_speed * check_finite_numbers("s", s) + self.phase


def _times(radius: float, function: str, angle: str) -> str:
    return f"{radius:g}{function}{angle}" if radius else "0"


@dataclass(frozen=True)
class EllipticNozzle(_Nozzle):
    """γ(s) = -v s e1 + (r1 cos(ωs + φ), r2 sin(ωs + φ)), the general case.

    Parameters
    ----------
    speed : float
        Belt speed v, -1 < v < 1.
    radius1, radius2 : float
        Radii r1 along and r2 across the belt, non-negative.
    angular_speed : float
        ω in radians per unit of arclength.
    phase : float
        φ in radians.

    Raises
    ------
    ValueError
        If v is not between -1 and 1, a radius negative, or a number not finite.

    References
    ----------
    [KMW09]_, section 4.2.
    """

    speed: float
    radius1: float
    radius2: float
    angular_speed: float
    phase: float = 0.0

    kind: ClassVar[str] = "elliptic_nozzle"

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "radius1", check_non_negative("radius1", self.radius1))
        object.__setattr__(self, "radius2", check_non_negative("radius2", self.radius2))

    @property
    def radii(self) -> tuple[float, float]:
        """Radii (r1, r2)."""
        return self.radius1, self.radius2


@dataclass(frozen=True)
class RotatingNozzle(_Nozzle):
    """γ(s) = -v s e1 + r (cos(ωs + φ), sin(ωs + φ)).

    Parameters
    ----------
    speed : float
        Belt speed v, -1 < v < 1.
    radius : float
        Radius r, non-negative.
    angular_speed : float
        ω in radians per unit of arclength.
    phase : float
        φ in radians.

    Raises
    ------
    ValueError
        If v is not between -1 and 1, the radius negative, or a number not finite.

    References
    ----------
    [KMW09]_, section 4.2 with r1 = r2.
    """

    speed: float
    radius: float
    angular_speed: float
    phase: float = 0.0

    kind: ClassVar[str] = "rotating_nozzle"

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "radius", check_non_negative("radius", self.radius))

    @property
    def radii(self) -> tuple[float, float]:
        """Radii (r, r)."""
        return self.radius, self.radius


@dataclass(frozen=True)
class OscillatingNozzle(_Nozzle):
    """γ(s) = -v s e1 + a sin(ωs + φ) e2: a nozzle that swings across the belt.

    Parameters
    ----------
    speed : float
        Belt speed v, -1 < v < 1.
    amplitude : float
        Amplitude a, non-negative.
    angular_speed : float
        ω in radians per unit of arclength.
    phase : float
        φ in radians.

    Raises
    ------
    ValueError
        If v is not between -1 and 1, the amplitude negative, or a number not finite.

    References
    ----------
    [KMW09]_, section 4.2 with r1 = 0.
    """

    speed: float
    amplitude: float
    angular_speed: float
    phase: float = 0.0

    kind: ClassVar[str] = "oscillating_nozzle"

    def __post_init__(self) -> None:
        super().__post_init__()
        amplitude = check_non_negative("amplitude", self.amplitude)
        object.__setattr__(self, "amplitude", amplitude)

    @property
    def radii(self) -> tuple[float, float]:
        """Radii (0, a)."""
        return 0.0, self.amplitude
