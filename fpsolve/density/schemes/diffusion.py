"""D: implicit α-diffusion ∂ₛp = (A²/2) ∂_αα p by periodic tridiagonal systems."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fpsolve._kernels.tridiagonal import solve_rows
from fpsolve._support.arrays import Array
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel

# Steps whose factors are remembered; a run needs one or two.
_KEPT = 4


class Elimination(NamedTuple):
    """Factors of circ(off, a, off)⁻¹ circ(side, centre, side); see the kernel."""

    numbers: tuple[float, float, float, float, float]
    pivots: Array
    response: Array


class ImplicitDiffusion:
    """∂ₛp = (A²/2) ∂_αα p, implicit: (M − θ ds D δ²) pⁿ⁺¹ = (M + (1 − θ) ds D δ²) pⁿ.

    θ = 1 is backward Euler (order 1), θ = 1/2 Crank-Nicolson (order 2), both stable
    for every step. With `compact` the mass matrix M = circ(1, 10, 1)/12 raises the
    order in Δα from 2 to 4 at the same cost. Keeps every row sum, and constants.
    Backward Euler with `compact=False` keeps the sign for every step.

    Parameters
    ----------
    model : LayDownModel
        Only `noise` is used.
    grid : PhaseSpaceGrid
    implicitness : float
        θ, 1 or 1/2.
    compact : bool
        Fourth order in Δα instead of second.
    """

    def __init__(
        self,
        model: LayDownModel,
        grid: PhaseSpaceGrid,
        implicitness: float = 0.5,
        compact: bool = True,
    ) -> None:
        self.diffusivity = model.diffusivity
        self.grid = grid
        self.implicitness = implicitness
        self.coupling = 1.0 / 12.0 if compact else 0.0
        self._factors: dict[float, Elimination] = {}

    def __call__(self, p: Array, s: float, ds: float, out: Array) -> None:
        """Advance p from s to s + ds into `out`."""
        if self.diffusivity == 0.0:
            out[...] = p
            return
        solve_rows(p, *self.factors(ds), out)

    def factors(self, ds: float) -> Elimination:
        """Elimination factors for the step ds."""
        known = self._factors
        if ds in known:
            return known[ds]
        number = self.diffusivity * ds / self.grid.spacing[2] ** 2
        implicit = self.implicitness * number
        explicit = number - implicit
        made = eliminate_circulant(
            off=self.coupling - implicit,
            side=self.coupling + explicit,
            n=self.grid.shape[2],
        )
        # A new table takes the place of the old: a thread may be reading that.
        self._factors = {**(known if len(known) <= _KEPT else {}), ds: made}
        return made


def eliminate_circulant(off: float, side: float, n: int) -> Elimination:
    """Sherman-Morrison factors; both circulants have row sum one."""
    diagonal, centre = 1.0 - 2.0 * off, 1.0 - 2.0 * side
    gamma = -diagonal
    main = np.full(n, diagonal)
    main[0] -= gamma
    main[-1] -= off * off / gamma
    pivots = np.empty(n)
    pivots[0] = 1.0 / main[0]
    for k in range(1, n):
        pivots[k] = 1.0 / (main[k] - off * off * pivots[k - 1])
    corner = np.zeros(n)
    corner[0], corner[-1] = gamma, off
    response = solve_tridiagonal(main, off, corner)
    scale = 1.0 / (1.0 + response[0] + off / gamma * response[-1])
    return Elimination((centre, side, off, gamma, float(scale)), pivots, response)


def solve_tridiagonal(main: Array, off: float, right: Array) -> Array:
    """Solution of the tridiagonal system with constant off-diagonal."""
    from scipy.linalg import solve_banded

    bands = np.zeros((3, main.size))
    bands[0, 1:], bands[1], bands[2, :-1] = off, main, off
    solution: Array = solve_banded((1, 1), bands, right)
    return solution
