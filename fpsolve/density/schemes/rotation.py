"""R½ D R½: rotation by the buckling force and angular diffusion at fixed ξ."""

from __future__ import annotations

import numpy as np

from fpsolve._kernels.rotation import RotationTable, rotate
from fpsolve._support.arrays import Array
from fpsolve.density.schemes.rotation_table import LARGEST_TABLE, rotation_table
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.at_points import gradient_at

# Bytes that are of no account beside what every run is allowed for overhead.
SMALL_CACHE = 16 * 2**20


class RotationDiffusion:
    """R½ D R½ with R: ∂ₛp = ∂_α(∇B·τ⊥ p) and D: ∂ₛp = (A²/2) ∂_αα p, at fixed ξ.

    Both parts are exact flows of trigonometric polynomials in α (with
    ∇B = |∇B|(cos φ, sin φ) the tangent of (α − φ)/2 grows by e^{|∇B| s}), applied as
    one small matrix per value of |∇B|; their symmetric composition is of order two
    in ds. Keeps the mass of every row to rounding (`balanced=False`) or constants
    (`balanced=True`, the equation of h = p/p_S). For a moving reference curve the
    balanced form includes the reaction (w·∇B) h, w = −γ′, exactly in time. Works for
    A = 0. Negative values can appear where p is under-resolved in α; `positive`
    limits each row (Zhang and Shu), which keeps its mass.

    Parameters
    ----------
    model : LayDownModel
    grid : PhaseSpaceGrid
        n_alpha even.
    balanced : bool
        Act on h = p/p_S instead of p.
    positive : bool
        Limit rows to non-negative values.

    Raises
    ------
    TypeError, ValueError
        If n_alpha is odd, or ∇B not a finite pair on the grid.
    """

    def __init__(
        self,
        model: LayDownModel,
        grid: PhaseSpaceGrid,
        balanced: bool = False,
        positive: bool = False,
    ) -> None:
        check_even(grid)
        self.model, self.grid = model, grid
        self.balanced, self.positive = balanced, positive
        xi1, xi2 = grid.plane()
        self.force = gradient_at(model.potential, xi1, xi2)
        self.strength = np.hypot(*self.force).ravel()
        angle = np.arctan2(self.force[1], self.force[0]).ravel()
        self.direction = np.stack([np.cos(angle), np.sin(angle)])
        self.transforms = angular_transforms(grid)
        self.still = np.ones(self.strength.size)
        self._tables: dict[float, RotationTable] = {}

    def __call__(self, p: Array, s: float, ds: float, out: Array) -> None:
        """Advance p from s to s + ds into `out`."""
        rotate(
            p.reshape(-1, p.shape[2]),
            self.table(ds),
            self.direction,
            self.transforms,
            self.reaction(s, ds),
            self.positive,
            out.reshape(-1, p.shape[2]),
        )

    def table(self, ds: float) -> RotationTable:
        """The matrices of R½ D R½ for the step ds."""
        known = self._tables
        if ds in known:
            return known[ds]
        table = rotation_table(
            self.strength,
            self.model.diffusivity,
            ds,
            self.grid.shape[2],
            self.balanced,
        )
        # A new dictionary takes the place of the old: a thread may be reading that.
        self._tables = {**self._kept_beside(table.nbytes, known), ds: table}
        return table

    def _kept_beside(
        self, nbytes: int, known: dict[float, RotationTable]
    ) -> dict[float, RotationTable]:
        # An extrapolation goes from step to step: keep all tables if they fit.
        held = sum(table.nbytes for table in known.values())
        room = max(LARGEST_TABLE * self.grid.nbytes, SMALL_CACHE)
        return known if held + nbytes <= room else {}

    def reaction(self, s: float, ds: float) -> Array:
        """Factor exp(−(γ(s + ds) − γ(s))·∇B) of the balanced form; (n1 n2,)."""
        if not self.balanced or self.model.curve.fixed:
            return self.still
        moved1, moved2 = self.model.curve.displacement(s, s + ds)
        exponent = -(moved1 * self.force[0] + moved2 * self.force[1])
        factor: Array = np.exp(exponent).ravel()
        return factor

    @property
    def n_arrays(self) -> float:
        """Memory held, in densities: at most three for the table."""
        return LARGEST_TABLE


def check_even(grid: PhaseSpaceGrid) -> None:
    """Raise if the angle has an odd number of cells."""
    if grid.shape[2] % 2:
        raise ValueError(
            f"`grid` must have an even number of angles, got {grid.shape[2]}; "
            f"use {grid.shape[2] + 1}."
        )


def angular_transforms(grid: PhaseSpaceGrid) -> tuple[Array, Array]:
    """Cosine and sine matrices on a quarter of the circle, and their inverses.

    Shape (2, 2, H, H): [cosine or sine, parity of the modes, angle, mode] and the
    inverse with mode before angle; H = n_alpha/4, rounded up.
    """
    n_alpha = grid.shape[2]
    half = n_alpha // 2
    quarter = -(-half // 2)
    forward = np.zeros((2, 2, quarter, quarter))
    for parity in (0, 1):
        modes = np.arange(parity, half, 2)
        angles = np.outer(grid.alpha[:quarter], modes)
        forward[0, parity, :, : modes.size] = np.cos(angles)
        forward[1, parity, :, : modes.size] = np.sin(angles)
    backward = np.ascontiguousarray(forward.swapaxes(2, 3)) * (2.0 / n_alpha)
    backward[0, 0, 0] /= 2.0
    return forward, backward
