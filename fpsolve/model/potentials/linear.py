"""The potential with a constant pull."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array, check_numbers
from fpsolve._support.checks import keep_checked
from fpsolve.model.potentials.potential import RadialPotential, check_length

__all__ = ["LinearPotential"]


@dataclass(frozen=True)
class LinearPotential(RadialPotential):
    """B(ξ) = K ‖ξ‖.

    The kink at the origin costs schemes their order there: keep the origin off the
    cell centres. On a moving belt the process is ergodic only for
    v < I1(2K/A²)/I0(2K/A²). Z = 2π/K² exactly.

    Parameters
    ----------
    slope : float
        The slope K, positive; 1 is the dimensionless form of the paper.

    Raises
    ------
    ValueError
        If the slope is not positive and finite.

    References
    ----------
    [KMW09]_, remark 3.1 and figure 5.
    """

    slope: float = 1.0

    kind: ClassVar[str] = "linear"

    def __post_init__(self) -> None:
        keep_checked(self, check_length, "slope")

    def radial_value(self, r: ArrayLike) -> Array:
        """K r."""
        return np.asarray(np.multiply(self.slope, check_numbers("r", r)))

    def radial_derivative(self, r: ArrayLike) -> Array:
        """K."""
        return np.full(check_numbers("r", r).shape, self.slope)

    @cached_property
    def partition_function(self) -> float:
        """Z = 2π/K²."""
        return 2 * math.pi / self.slope**2

    @property
    def formula(self) -> str:
        """B as plain text."""
        return "‖ξ‖" if self.slope == 1 else f"{self.slope:g} ‖ξ‖"

    @property
    def latex(self) -> str:
        """B as LaTeX."""
        return r"\|\xi\|" if self.slope == 1 else rf"{self.slope:g}\,\|\xi\|"
