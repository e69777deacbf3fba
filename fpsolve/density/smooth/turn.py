"""K and R: the force on the curvature, and on the angle where κ follows at once."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from fpsolve._kernels.rotation import RotationTable, rotate
from fpsolve._kernels.smooth import kick
from fpsolve._support.arrays import Array
from fpsolve.density.schemes.rotation import angular_transforms, check_even
from fpsolve.density.schemes.rotation_table import rotation_table
from fpsolve.grids.smooth import SmoothPhaseSpaceGrid
from fpsolve.model.potentials.at_points import gradient_at
from fpsolve.model.smooth import SmoothLayDownModel

__all__ = ["Kick", "Rotation"]


class Kick:
    """∂ₛp + F ∂_κ p = 0, F = -∇B·τ⊥(α): the curvature moves by F ds at fixed (ξ, α).

    Exact for what the cells hold in κ. Conserves mass.

    Parameters
    ----------
    model : SmoothLayDownModel
    grid : SmoothPhaseSpaceGrid
    """

    def __init__(self, model: SmoothLayDownModel, grid: SmoothPhaseSpaceGrid) -> None:
        force1, force2 = gradient_at(model.potential, *grid.plane())
        self.force = np.ascontiguousarray(force1).ravel(), force2.ravel()
        self.waves = np.cos(grid.alpha), np.sin(grid.alpha)
        self.unit = np.pi / grid.kappa_half_width

    def __call__(self, u: Array, s: float, ds: float, out: Array) -> None:
        """Move the modes u into `out`, which may be u."""
        rows = (-1, *u.shape[2:])
        target = out.reshape(rows)
        kick(u.reshape(rows), *self.force, *self.waves, self.unit * ds, target)


class Rotation:
    """∂ₛp + ∂_α(F p) = 0, F = -∇B·τ⊥(α): the angle follows the force at fixed (ξ, κ).

    The exact flow of trigonometric polynomials in α, one small matrix per value of
    |∇B|, as in the `RotationDiffusion` of the basic model. Conserves mass.

    Parameters
    ----------
    model : SmoothLayDownModel
    grid : SmoothPhaseSpaceGrid
        n_alpha even.
    """

    def __init__(self, model: SmoothLayDownModel, grid: SmoothPhaseSpaceGrid) -> None:
        check_even(grid.phase_space)
        self.grid = grid
        self.force = gradient_at(model.potential, *grid.plane())
        self.transforms = angular_transforms(grid.phase_space)
        self._tables: dict[float, RotationTable] = {}

    def __call__(self, u: Array, s: float, ds: float, out: Array) -> None:
        """Turn the modes u into `out`."""
        rows = (-1, u.shape[3])
        rotate(
            u.reshape(rows), self.table(ds), self._direction, self.transforms,
            self._unchanged, False, out.reshape(rows),
        )  # fmt: skip

    # One entry for every ξ and mode in κ: made by the first step, when it is known
    # that the run fits into memory.
    @cached_property
    def _direction(self) -> Array:
        angle = np.arctan2(self.force[1], self.force[0]).ravel()
        unit = np.stack([np.cos(angle), np.sin(angle)])
        return np.repeat(unit, self.grid.shape[3], axis=1)

    @cached_property
    def _unchanged(self) -> Array:
        return np.ones(self._direction.shape[1])

    def table(self, ds: float) -> RotationTable:
        """The matrices of the flow over ds."""
        if ds not in self._tables:
            each = np.repeat(np.hypot(*self.force).ravel(), self.grid.shape[3])
            made = rotation_table(each, 0.0, ds, self.grid.shape[2], False)
            # A new dictionary takes the place of the old: a thread may be reading that.
            kept = self._tables if len(self._tables) < 2 else {}
            self._tables = {**kept, ds: made}
        return self._tables[ds]
