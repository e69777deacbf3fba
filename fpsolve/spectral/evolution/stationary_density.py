"""A stationary density by expansion, on whatever grid is chosen."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

from fpsolve._support.arrays import Array
from fpsolve.errors import ToleranceError
from fpsolve.evolution.saved import Saved
from fpsolve.spectral.evolution.quadratic import checked_tolerance

__all__ = ["StationaryDensity"]


class StationaryDensity(Saved, ABC):
    """A result whose density is known in two truncations."""

    def density(self, grid: Any, *, tolerance: float = 1e-2) -> Array:
        """p at the cell centres of a grid; shape ``grid.shape``.

        A `PhaseSpaceGrid` for basic fibres, a `SmoothPhaseSpaceGrid` for smooth ones.
        Moments need the first coefficients only, the density all of them: where the
        belt has moved it far from e^{−B}, the moments are exact and the density is not
        known at all.

        Raises
        ------
        ToleranceError
            If `density_error` is above `tolerance`.
        """
        tolerance = checked_tolerance(tolerance)
        p, error = self._density_and_error(grid)
        if not error <= tolerance:
            remedy = (
                "lower the `tolerance` of `spectral_steady_state`, which raises the "
                "truncation, or use `steady_state`"
            )
            raise ToleranceError(error, tolerance, remedy)
        return p

    def density_error(self, grid: Any) -> float:
        """∫ |p − p′| on a grid, p′ from the next coarser truncation."""
        return self._density_and_error(grid)[1]

    @abstractmethod
    def _density_and_error(self, grid: Any) -> tuple[Array, float]:
        """p on a grid, and its distance to that of the coarser truncation."""
