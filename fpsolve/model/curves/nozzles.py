"""Nozzles that circle or swing above a moving belt."""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array, check_finite_numbers
from fpsolve._support.checks import check_finite, check_non_negative, keep_checked
from fpsolve.model.curves.curve import Curve, check_speed

__all__ = ["EllipticNozzle", "OscillatingNozzle", "RotatingNozzle"]


class _Nozzle(Curve):
    """γ(s) = -v s e1 + (r1 cos(ωs + φ), r2 sin(ωs + φ)) with radii from a subclass."""

    angular_speed: float
    phase: float
    # Names of the fields that are radii.
    _lengths: ClassVar[tuple[str, ...]]

    @property
    @abstractmethod
    def radii(self) -> tuple[float, float]:
        """Radii (r1, r2) along and across the belt."""

    def __post_init__(self) -> None:
        keep_checked(self, check_speed, "speed")
        keep_checked(self, check_finite, "angular_speed", "phase")
        keep_checked(self, check_non_negative, *self._lengths)

    def position(self, s: ArrayLike) -> tuple[Array, Array]:
        """-v s e1 + (r1 cos(ωs + φ), r2 sin(ωs + φ))."""
        (radius1, radius2), angle = self.radii, self._angle(s)
        along = radius1 * np.cos(angle) - self.speed * check_finite_numbers("s", s)
        return np.asarray(along), np.asarray(radius2 * np.sin(angle))

    def velocity(self, s: ArrayLike) -> tuple[Array, Array]:
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
    def period(self) -> float:
        """Arclength 2π/|ω| after which γ' repeats itself; infinite for ω = 0."""
        return 2 * math.pi / abs(self.angular_speed) if self.angular_speed else math.inf

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
        return self._written(" s e₁", " cos", " sin", " ")

    @property
    def latex(self) -> str:
        """γ(s) as LaTeX."""
        return self._written(r"\,s\,e_1", r"\cos", r"\sin", r"\ ")

    def _written(self, along_belt: str, cosine: str, sine: str, space: str) -> str:
        belt = f"{-self.speed:g}{along_belt} + " if self.speed else ""
        terms = [
            f"{radius:g}{function}({self._angle_text()})" if radius else "0"
            for radius, function in zip(self.radii, (cosine, sine), strict=True)
        ]
        return f"{belt}({terms[0]},{space}{terms[1]})"

    def _angle_text(self) -> str:
        if self.phase == 0:
            return f"{self.angular_speed:g} s"
        sign = "-" if self.phase < 0 else "+"
        return f"{self.angular_speed:g} s {sign} {abs(self.phase):g}"

    def _angle(self, s: ArrayLike) -> Array:
        return self.angular_speed * check_finite_numbers("s", s) + self.phase


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
    _lengths: ClassVar[tuple[str, ...]] = ("radius1", "radius2")

    @property
    def radii(self) -> tuple[float, float]:
        """Radii (r1, r2)."""
        return self.radius1, self.radius2


@dataclass(frozen=True)
class RotatingNozzle(_Nozzle):
    """γ(s) = -v s e1 + r (cos(ωs + φ), sin(ωs + φ)).

    Parameters
    ----------
    speed, angular_speed, phase : float
        v, ω and φ as for `EllipticNozzle`.
    radius : float
        Radius r, non-negative.

    Raises
    ------
    ValueError
        As for `EllipticNozzle`.

    References
    ----------
    [KMW09]_, section 4.2 with r1 = r2.
    """

    speed: float
    radius: float
    angular_speed: float
    phase: float = 0.0

    kind: ClassVar[str] = "rotating_nozzle"
    _lengths: ClassVar[tuple[str, ...]] = ("radius",)

    @property
    def radii(self) -> tuple[float, float]:
        """Radii (r, r)."""
        return self.radius, self.radius


@dataclass(frozen=True)
class OscillatingNozzle(_Nozzle):
    """γ(s) = -v s e1 + a sin(ωs + φ) e2: a nozzle that swings across the belt.

    Parameters
    ----------
    speed, angular_speed, phase : float
        v, ω and φ as for `EllipticNozzle`.
    amplitude : float
        Amplitude a, non-negative.

    Raises
    ------
    ValueError
        As for `EllipticNozzle`.

    References
    ----------
    [KMW09]_, section 4.2 with r1 = 0.
    """

    speed: float
    amplitude: float
    angular_speed: float
    phase: float = 0.0

    kind: ClassVar[str] = "oscillating_nozzle"
    _lengths: ClassVar[tuple[str, ...]] = ("amplitude",)

    @property
    def radii(self) -> tuple[float, float]:
        """Radii (0, a)."""
        return 0.0, self.amplitude
