"""Powers of the distance, between the linear potential and a wall."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array, check_numbers
from fpsolve._support.checks import check_real, keep_checked
from fpsolve.model.potentials.potential import RadialPotential, check_length

__all__ = ["PowerPotential"]


@dataclass(frozen=True)
class PowerPotential(RadialPotential):
    """B(ξ) = (‖ξ‖/c)ⁿ / n.

    The division by n gives B'(c) = 1/c, so c = 1 is the dimensionless form
    B'(1) = 1. The exponent 1 is the linear, 2 the quadratic potential.
    Z = 2π c² n^(2/n - 1) Γ(2/n) exactly.

    Parameters
    ----------
    exponent : float
        The exponent n >= 1.
    scale : float
        The scale c, positive.

    Raises
    ------
    ValueError
        If the exponent is below 1 or the scale is not positive.

    References
    ----------
    [KMW09]_, remarks 3.1 and 3.4.
    """

    exponent: float
    scale: float = 1.0

    kind: ClassVar[str] = "power"

    def __post_init__(self) -> None:
        exponent = check_real("exponent", self.exponent)
        if not 1 <= exponent < math.inf:
            raise ValueError(
                f"`exponent` must be at least 1 and finite, got {exponent:g}; below 1 "
                "the gradient is singular at the origin."
            )
        object.__setattr__(self, "exponent", exponent)
        keep_checked(self, check_length, "scale")

    def radial_value(self, r: ArrayLike) -> Array:
        """(r/c)ⁿ / n."""
        r = check_numbers("r", r)
        return np.asarray(np.divide(r, self.scale) ** self.exponent / self.exponent)

    def radial_derivative(self, r: ArrayLike) -> Array:
        """(r/c)ⁿ⁻¹ / c."""
        scaled = np.divide(check_numbers("r", r), self.scale)
        return np.asarray(scaled ** (self.exponent - 1) / self.scale)

    @cached_property
    def partition_function(self) -> float:
        """Z = 2π c² n^(2/n - 1) Γ(2/n)."""
        ratio = 2 / self.exponent
        power = math.pow(self.exponent, ratio - 1)
        return 2 * math.pi * self.scale**2 * power * math.gamma(ratio)

    @property
    def formula(self) -> str:
        """B as plain text."""
        base = "‖ξ‖" if self.scale == 1 else f"(‖ξ‖/{self.scale:g})"
        return f"{base}^{self.exponent:g}/{self.exponent:g}"

    @property
    def latex(self) -> str:
        """B as LaTeX."""
        base = r"\|\xi\|" if self.scale == 1 else rf"(\|\xi\|/{self.scale:g})"
        return rf"\frac{{{base}^{{{self.exponent:g}}}}}{{{self.exponent:g}}}"
