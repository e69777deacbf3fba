"""What holds a fibre at its ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fpsolve._support.arrays import Array, check_finite_numbers
from fpsolve._support.checks import shown

__all__ = [
    "Clamped",
    "End",
    "Free",
    "Hinged",
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
    """Where the end is held, or None."""
    return None if isinstance(end, Free) else np.array(end.position)


def as_vector(name: str, value: object) -> Vector:
    """Three numbers as a tuple; ValueError if they are not."""
    found = check_finite_numbers(name, value)
    if found.shape != (3,):
        raise ValueError(f"`{name}` must be three numbers, got {shown(value)}.")
    first, second, third = found.tolist()
    return first, second, third
