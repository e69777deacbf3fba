"""The standard potential of the paper."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array, check_numbers
from fpsolve._support.checks import keep_checked
from fpsolve.model.potentials.potential import Potential, check_length

__all__ = ["QuadraticPotential"]


@dataclass(frozen=True)
class QuadraticPotential(Potential):
    """B(ξ) = (ξ1²/σ1² + ξ2²/σ2²)/2.

    The stationary density is Gaussian with the variances σ1² and σ2², hence the name
    throwing ranges. Isotropic when they are equal. Z = 2π σ1 σ2 exactly.

    Parameters
    ----------
    sigma1, sigma2 : float
        Throwing ranges along and across the belt, positive.

    Raises
    ------
    ValueError
        If a throwing range is not positive and finite.

    References
    ----------
    [KMW09]_, section 3.1, below equation (6).
    """

    sigma1: float = 1.0
    sigma2: float = 1.0

    kind: ClassVar[str] = "quadratic"

    def __post_init__(self) -> None:
        keep_checked(self, check_length, "sigma1", "sigma2")

    @property
    def isotropic(self) -> bool:
        """Whether σ1 = σ2."""
        return self.sigma1 == self.sigma2

    def value(self, xi1: ArrayLike, xi2: ArrayLike) -> Array:
        """B(ξ1, ξ2), float64, in the broadcast shape of the arguments."""
        scaled1 = np.divide(check_numbers("xi1", xi1), self.sigma1)
        scaled2 = np.divide(check_numbers("xi2", xi2), self.sigma2)
        return np.asarray(0.5 * (scaled1**2 + scaled2**2))

    def gradient(self, xi1: ArrayLike, xi2: ArrayLike) -> tuple[Array, Array]:
        """(ξ1/σ1², ξ2/σ2²), two float64 arrays in the broadcast shape."""
        xi1, xi2 = check_numbers("xi1", xi1), check_numbers("xi2", xi2)
        slope1, slope2 = np.broadcast_arrays(xi1 / self.sigma1**2, xi2 / self.sigma2**2)
        return np.array(slope1), np.array(slope2)

    @cached_property
    def partition_function(self) -> float:
        """Z = 2π σ1 σ2."""
        return 2 * math.pi * self.sigma1 * self.sigma2

    @property
    def formula(self) -> str:
        """B as plain text."""
        return f"({_over('ξ₁²', self.sigma1)} + {_over('ξ₂²', self.sigma2)})/2"

    @property
    def latex(self) -> str:
        """B as LaTeX."""
        first = _latex_over(r"\xi_1^2", self.sigma1)
        second = _latex_over(r"\xi_2^2", self.sigma2)
        return rf"\frac12\left({first} + {second}\right)"


def _over(square: str, sigma: float) -> str:
    return square if sigma == 1 else f"{square}/{sigma:g}²"


def _latex_over(square: str, sigma: float) -> str:
    return square if sigma == 1 else rf"\frac{{{square}}}{{{sigma:g}^2}}"
