"""The inextensible fibre with bending stiffness, and what it is made of."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array
from fpsolve._support.checks import (
    check_integer,
    check_non_negative,
    check_positive,
    keep_checked,
)
from fpsolve.fibre.dictionaries import end_from_dict, end_to_dict
from fpsolve.fibre.ends import (
    Clamped,
    End,
    Free,
    Vector,
    as_vector,
    check_end,
    place_of,
)

__all__ = ["String"]

# As a fibre leaves a nozzle.
DOWN, FREE = Clamped((0.0, 0.0, 0.0), (0.0, 0.0, -1.0)), Free()
# Fewer have no shape.
FEWEST_EDGES = 4


@dataclass(frozen=True)
class String:
    """ρA ∂_tt r = ∂_s(T ∂_s r − ∂_s(EI ∂_ss r)) + ρA g, |∂_s r| = 1.

    The fibre is a chain of n edges e_i = r_{i+1} − r_i of the fixed length h. Each node
    has the mass of half of its edges, and the bending energy is EI/2 Σ h |r_{i+1} −
    2 r_i + r_{i−1}|²/h⁴, at a clamped end EI/h |e/h − τ|² besides: quadratic, so that
    bending is a linear force. Shapes and frequencies have errors of order 2 in h.
    The tension T_i of an edge is the multiplier of |e_i| = h. SI units.

    Parameters
    ----------
    length : float
        Of the fibre, in m.
    diameter : float
        d in m; the cross section is a circle.
    density : float
        ρ of the material, in kg/m³.
    youngs_modulus : float
        E in Pa; 0 for a chain without bending stiffness.
    start, end : Free, Hinged or Clamped
        What holds both ends.
    gravity : tuple of float
        g in m/s².
    n_edges : int
        Of the chain, at least 4.

    Raises
    ------
    ValueError
        If a number is out of its range, or the two ends are held further apart than
        the fibre is long.
    TypeError
        If an end is none.

    References
    ----------
    [KMW09]_, equation (4).
    """

    _recorded: ClassVar[str] = "string"

    length: float
    diameter: float
    density: float
    youngs_modulus: float
    start: End = DOWN
    end: End = FREE
    gravity: Vector = (0.0, 0.0, -9.81)
    n_edges: int = 64

    def __post_init__(self) -> None:
        keep_checked(self, check_positive, "length", "diameter", "density")
        keep_checked(self, check_non_negative, "youngs_modulus")
        keep_checked(self, check_end, "start", "end")
        keep_checked(self, as_vector, "gravity")
        n_edges = check_integer("n_edges", self.n_edges, FEWEST_EDGES)
        object.__setattr__(self, "n_edges", n_edges)
        first, last = place_of(self.start), place_of(self.end)
        if first is not None and last is not None:
            apart = float(np.linalg.norm(last - first))
            if not apart < self.length:
                raise ValueError(
                    f"`length` must be above the distance {apart:g} of the ends, got "
                    f"{self.length:g}; the fibre does not stretch."
                )

    @property
    def line_density(self) -> float:
        """ρA = ρ π d²/4 in kg/m."""
        return self.density * math.pi * self.diameter**2 / 4

    @property
    def bending_stiffness(self) -> float:
        """EI = E π d⁴/64 in N m²."""
        return self.youngs_modulus * math.pi * self.diameter**4 / 64

    @property
    def edge(self) -> float:
        """h, the length of an edge in m."""
        return self.length / self.n_edges

    @property
    def s(self) -> Array:
        """Arclength of the nodes, shape (n_edges + 1,)."""
        return np.linspace(0.0, self.length, self.n_edges + 1)

    @cached_property
    def masses(self) -> Array:
        """Of the nodes in kg, shape (n_edges + 1,)."""
        masses = np.full(self.n_edges + 1, self.line_density * self.edge)
        masses[[0, -1]] *= 0.5
        return masses

    @cached_property
    def moving(self) -> NDArray[np.int64]:
        """Places of the nodes that are not held."""
        held = [place_of(one) is not None for one in (self.start, self.end)]
        return np.arange(self.n_edges + 1)[held[0] : self.n_edges + 1 - held[1]]

    def to_dict(self) -> dict[str, Any]:
        """The parameters, as JSON holds them."""
        about = {one.name: getattr(self, one.name) for one in fields(self)}
        ends = {name: end_to_dict(about[name]) for name in ("start", "end")}
        return {**about, **ends}

    @classmethod
    def from_dict(cls, about: Mapping[str, Any]) -> String:
        """The fibre; ValueError unless it is described as `to_dict` does."""
        names = [one.name for one in fields(cls)]
        if sorted(about) != sorted(names):
            raise ValueError(
                f"a fibre must have {', '.join(names)}, got {', '.join(about)}."
            )
        ends = {name: end_from_dict(about[name]) for name in ("start", "end")}
        return cls(**{**about, **ends})

    def coarser(self) -> String:
        """The same fibre with half of the edges."""
        return replace(self, n_edges=self.n_edges // 2)
