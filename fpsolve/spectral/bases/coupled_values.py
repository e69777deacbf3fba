"""Functions of many angular indices on a grid of (ξ, α, κ)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fpsolve._support.arrays import Array, Complex
from fpsolve.grids.smooth import SmoothPhaseSpaceGrid
from fpsolve.spectral.bases.body_frame_values import values_on
from fpsolve.spectral.bases.coupled_states import CoupledStates
from fpsolve.spectral.bases.placement import Placement
from fpsolve.spectral.bases.sectors import Vector
from fpsolve.spectral.bases.weights import Weight

__all__ = ["coupled_values"]


@dataclass(frozen=True)
class _Round:
    """The cells of a grid in the coordinates x1 = (ξ1 - c)/S1 and x2 = ξ2/S2."""

    grid: SmoothPhaseSpaceGrid
    placement: Placement

    @property
    def shape(self) -> tuple[int, ...]:
        return self.grid.shape

    @property
    def alpha(self) -> Array:
        return self.grid.alpha

    @property
    def kappa(self) -> Array:
        return self.grid.kappa

    def plane(self) -> tuple[Array, Array]:
        xi1, xi2 = self.grid.plane()
        width1, width2 = self.placement.widths
        return (xi1 - self.placement.centre) / width1, xi2 / width2


def coupled_values(
    states: CoupledStates,
    vector: Vector,
    placement: Placement,
    weights: tuple[Weight, Weight],
    grid: SmoothPhaseSpaceGrid,
) -> Complex:
    """The sum over all M of functions times the weights; shape ``grid.shape``."""
    cells = _Round(grid, placement)
    result = np.zeros(grid.shape, np.complex128)
    for index, plain in states.signed(vector):
        result += values_on(states.table(plain), index, *weights, cells)
    return result
