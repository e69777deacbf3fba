"""No potential at all."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array, check_numbers
from fpsolve.model.potentials.potential import RadialPotential

__all__ = ["FreePotential"]


@dataclass(frozen=True)
class FreePotential(RadialPotential):
    """B(ξ) = 0: the persistent random walk.

    Nothing brings the fibre back, so there is no stationary density; useful because
    its moments are known: E cos(α_s - α_0) = exp(-A² s/2) and
    E‖ξ_s - ξ_0‖² = (4/A²)(s - (2/A²)(1 - exp(-A² s/2))).
    """

    kind: ClassVar[str] = "free"
    formula = latex = "0"

    def radial_value(self, r: ArrayLike) -> Array:
        """0."""
        return np.zeros(check_numbers("r", r).shape)

    def radial_derivative(self, r: ArrayLike) -> Array:
        """0."""
        return np.zeros(check_numbers("r", r).shape)

    @cached_property
    def partition_function(self) -> float:
        """Infinite: exp(-B) = 1 has no integral over the plane."""
        return math.inf
