"""What bases of a smooth fibre have beyond those of a basic one."""

from __future__ import annotations

from abc import abstractmethod
from typing import Any, ClassVar

from fpsolve._support.arrays import Complex
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.spectral.bases.sectors import Discretisation, Sector, Truncation, Vector

__all__ = ["SmoothDiscretisation"]


class SmoothDiscretisation(Discretisation):
    """L of (23) between two families of functions, dual to each other.

    No stationary density is known in whose L² the basis could be orthonormal.
    Eigenfunctions of L and densities are expanded in functions of their own, see
    `Weight`, and vectors of the transposed matrix are densities.
    """

    model: SmoothLayDownModel
    # Four and three coordinates: the symmetric order fills the factors.
    ordering: ClassVar[str | None] = "COLAMD"
    # The constants are not among the functions, so that a truncation has not quite 0.
    zero: ClassVar[float] = 1e-3

    @property
    def reversible(self) -> bool:
        """False: turning the fibre round does not take L to its adjoint."""
        return False

    @property
    def stationary_sector(self) -> Sector:
        """Where the constants belong, and the stationary density."""
        return next(sector for sector in self.sectors() if sector.has_constants)

    @abstractmethod
    def dual_values(
        self,
        vector: Vector,
        sector: Sector,
        truncation: Truncation,
        grid: Any,
    ) -> Complex:
        """The density of a vector of the transposed matrix, on a grid.

        Its pairing ∫ p f with f of `values` is that of the coefficients.
        """

    @abstractmethod
    def stationary_moments(
        self, vector: Vector, truncation: Truncation
    ) -> dict[str, float]:
        """`mass` and SMOOTH_MOMENTS over the mass, of the stationary sector."""
