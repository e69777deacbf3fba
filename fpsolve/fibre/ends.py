"""What holds a fibre at its ends."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import ClassVar

import numpy as np

from fpsolve._support.arrays import Array, check_finite_numbers
from fpsolve._support.checks import (
    check_finite,
    check_positive,
    keep_checked,
    shown,
)

__all__ = [
    "Belt",
    "Clamped",
    "End",
    "Free",
    "Hinged",
    "Nozzle",
    "Vector",
    "as_vector",
    "check_end",
    "place_of",
]

Vector = tuple[float, float, float]
# A direction that is shorter is none: its length would be rounding.
SHORTEST = 1e-100


@dataclass(frozen=True)
class Free:
    """T = 0 and no bending moment: nothing holds the end."""


@dataclass(frozen=True)
class Hinged:
    """r = `position`, no bending moment: the end stays and turns freely.

    Parameters
    ----------
    position : tuple of float
        In m.
    """

    position: Vector

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", as_vector("position", self.position))


@dataclass(frozen=True)
class Clamped:
    """r = `position`, ∂_s r = `direction`: neither place nor tangent of the end move.

    Parameters
    ----------
    position : tuple of float
        In m.
    direction : tuple of float
        Of the fibre from its beginning to its end, also where this is the end; of any
        length but 0.
    """

    position: Vector
    direction: Vector

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", as_vector("position", self.position))
        direction = np.array(as_vector("direction", self.direction))
        length = float(np.linalg.norm(direction))
        if not length > SHORTEST:
            raise ValueError(
                f"`direction` must not vanish, got {shown(self.direction)}; it is the "
                "tangent of the fibre."
            )
        object.__setattr__(self, "direction", tuple((direction / length).tolist()))


@dataclass(frozen=True)
class Nozzle(Clamped):
    """r = x(t) + d τ, ∂_t r = x'(t) + v_in τ: fibre is spun out along `direction` τ.

    x(t) = `position` + (r₁ cos(ωt + φ), r₂ sin(ωt + φ), 0): at rest, on an ellipse, or
    to and fro. Pieces of the fibre keep the nozzle's velocity and v_in until they have
    come out by the length of one edge, so that the place where the fibre is clamped
    lies within half of an edge of x(t).

    Parameters
    ----------
    position : tuple of float
        In m, the centre of the motion.
    direction : tuple of float
        In which the fibre comes out, of any length but 0.
    speed : float
        v_in in m/s, the length of fibre per time.
    radii : tuple of float
        r₁ and r₂ in m, along the belt and across.
    angular_speed : float
        ω in rad/s.
    phase : float
        φ.

    Raises
    ------
    ValueError
        If the speed is not positive, or a number is not finite.

    References
    ----------
    [KMW09]_, sections 2.2 and 4.1.
    """

    speed: float
    radii: tuple[float, float] = (0.0, 0.0)
    angular_speed: float = 0.0
    phase: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        keep_checked(self, check_positive, "speed")
        keep_checked(self, check_finite, "angular_speed", "phase")
        radii = check_finite_numbers("radii", self.radii)
        if radii.shape != (2,):
            raise ValueError(f"`radii` must be two numbers, got {shown(self.radii)}.")
        object.__setattr__(self, "radii", tuple(radii.tolist()))

    def at(self, t: float) -> tuple[Array, Array]:
        """x(t) in m, and the velocity x'(t) + v_in τ of what comes out, in m/s."""
        angle = self.angular_speed * t + self.phase
        cosine, sine = math.cos(angle), math.sin(angle)
        first, second = self.radii
        offset = np.array([first * cosine, second * sine, 0.0])
        moving = self.angular_speed * np.array([-first * sine, second * cosine, 0.0])
        spun = self.speed * np.array(self.direction)
        return np.array(self.position) + offset, moving + spun


@dataclass(frozen=True)
class Belt:
    """z = `height`, moving with v_belt e₁: what touches it lies there.

    A node that reaches the belt has its velocity from then on, as by friction without
    limit; the impact is plastic. What lies cannot move, and nothing is below the belt.
    With `friction` μ, Coulomb's law, what lies is held by at most μ times what presses
    it down, slides where more pulls at it, and rises where it is lifted. Loops of a
    stiff fibre stand on the belt. Suction through it presses them down: after a
    settling time they are taken to lie under where they stand.

    Parameters
    ----------
    speed : float
        v_belt in m/s.
    height : float
        In m.
    settling_time : float
        In s, positive; infinite by default.
    friction : float
        μ, not negative; infinite by default: what lies sticks.

    Raises
    ------
    ValueError
        If a number is not finite, the time not positive, or the friction negative.

    References
    ----------
    [KMW09]_, section 2.2.3; [ALC91]_ for the iterations that settle friction.
    """

    _recorded: ClassVar[str] = "belt"

    speed: float
    height: float = 0.0
    settling_time: float = math.inf
    friction: float = math.inf

    def __post_init__(self) -> None:
        keep_checked(self, check_finite, "speed", "height")
        if not self.settling_time > 0:
            raise ValueError(
                f"`settling_time` must be positive, got {shown(self.settling_time)}."
            )
        if not self.friction >= 0:
            raise ValueError(
                f"`friction` must be non-negative, got {shown(self.friction)}; "
                "`math.inf` lets all that lies stick."
            )

    def to_dict(self) -> dict[str, float]:
        """The parameters, as JSON holds them."""
        return {one.name: getattr(self, one.name) for one in fields(self)}


End = Free | Hinged | Clamped


def check_end(name: str, end: End) -> End:
    """Return it; TypeError unless it is an end."""
    if not isinstance(end, Free | Hinged | Clamped):
        raise TypeError(
            f"`{name}` must be `Free()`, `Hinged(position)` or `Clamped(position, "
            f"direction)`, got {shown(end)}."
        )
    return end


def place_of(end: End) -> Array | None:
    """Where the end is held at time 0, or None."""
    if isinstance(end, Free):
        return None
    return end.at(0.0)[0] if isinstance(end, Nozzle) else np.array(end.position)


def as_vector(name: str, value: object) -> Vector:
    """Three numbers as a tuple; ValueError if they are not."""
    found = check_finite_numbers(name, value)
    if found.shape != (3,):
        raise ValueError(f"`{name}` must be three numbers, got {shown(value)}.")
    first, second, third = found.tolist()
    return first, second, third
