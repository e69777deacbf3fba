"""The circulation of a density, whose decay is known exactly on a belt at rest."""

from __future__ import annotations

import math

import numpy as np

from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.row_sums import RowFunctionals
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.at_points import value_at
from fpsolve.model.potentials.potential import Potential

__all__ = ["Circulation", "obeys_circulation_law", "remaining"]


def obeys_circulation_law(model: LayDownModel) -> bool:
    """Whether E G decays as e^{−A²s/2}: B depends on ‖ξ‖ only and the belt rests."""
    return bool(model.curve.fixed and model.potential.isotropic)


class Circulation:
    """E G/max|G| with G = e^{−B} (ξ₁ sin α − ξ₂ cos α), read off sums over α.

    For B(‖ξ‖) on a belt at rest L G = −(A²/2) G, so that E G decays as e^{−A²s/2}
    from every start, for every B and A. |E_p G − E_q G| ≤ max|G| ‖p − q‖₁: what a
    density misses of that law its L1 error has at least.

    Parameters
    ----------
    potential : Potential
        B, of which only differences on the grid matter.
    grid : PhaseSpaceGrid
    """

    def __init__(self, potential: Potential, grid: PhaseSpaceGrid) -> None:
        xi1, xi2 = grid.plane()
        value = value_at(potential, xi1, xi2)
        weight = np.exp(value.min() - value)
        largest = float((weight * np.hypot(xi1, xi2)).max())
        # Where e^{−B} is left in one cell, at the origin, there is no circulation.
        weight /= largest if largest > 0.0 else 1.0
        self.arm1, self.arm2 = weight * xi1, weight * xi2

    def of(self, found: RowFunctionals) -> float:
        """The circulation of a density, between −1 and 1; mass does not matter."""
        cosines, sines = found.rows[1], found.rows[2]
        total = float((self.arm1 * sines - self.arm2 * cosines).sum())
        return total / found.totals[0] if found.totals[0] else math.nan


def remaining(noise: float, distance: float) -> float:
    """e^{−A²s/2}, what is left of a circulation after the arclength s."""
    return math.exp(-0.5 * noise * noise * distance)
