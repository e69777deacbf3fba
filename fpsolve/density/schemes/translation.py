"""T: the exact translation ∂ₛp + (τ(α) − γ′(s))·∇_ξ p = 0 at fixed angle."""

from __future__ import annotations

from typing import Any

import numpy as np

from fpsolve._kernels.translation import translate, translate_positive
from fpsolve._support.arrays import Array
from fpsolve.density.schemes.stencils import Taps, check_order, flux_taps, shift_taps
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.fibre import FibreModel

# A step needs the taps of two shifts (whole and half), Richardson those of four.
_KEPT = 8


class Translation:
    """∂ₛp + (τ(α) − γ′(s))·∇_ξ p = 0 by Lagrange interpolation in ξ.

    The shift τ(α) ds − (γ(s + ds) − γ(s)) is exact for every reference curve; the
    only error is that of the interpolation, of the given order in Δξ at every
    application. Keeps the mass to rounding on the periodic box, and constants. With
    `positive` the shift is written with fluxes, each held between zero and what the
    donor cell contains: non-negative densities stay so, and mass is still kept.

    Parameters
    ----------
    model : FibreModel
        Only `curve` is used.
    grid : PhaseSpaceGrid
    order : int
        Number of points of the interpolation in each direction, even.
    positive : bool
        Clamp the fluxes.

    Attributes
    ----------
    kept : int
        Taps that are remembered: those of a few steps, unless a whole period of a
        curve is gone through again and again.
    """

    def __init__(
        self,
        model: FibreModel,
        grid: PhaseSpaceGrid,
        order: int = 8,
        positive: bool = False,
    ) -> None:
        self.curve = model.curve
        self.grid = grid
        self.order = check_order(order)
        self.positive = positive
        self.kept = _KEPT
        self._taps: dict[tuple[float, float], tuple[Taps, ...]] = {}

    def shifts(self, s: float, ds: float) -> tuple[Array, Array]:
        """Shift from s to s + ds in cells, for both directions; shape (n_alpha,)."""
        moved1, moved2 = self.curve.displacement(s, s + ds)
        d1, d2, _ = self.grid.spacing
        alpha = self.grid.alpha
        return (np.cos(alpha) * ds - moved1) / d1, (np.sin(alpha) * ds - moved2) / d2

    def __call__(self, p: Array, s: float, ds: float, out: Array) -> None:
        """Advance p from s to s + ds into `out`."""
        taps = self._remembered_taps(s, ds)
        kernel: Any = translate_positive if self.positive else translate
        kernel(p, *taps, out)

    def _remembered_taps(self, s: float, ds: float) -> tuple[Taps, ...]:
        # Rounding of s must not defeat the memory for belts of constant speed.
        start = 0.0 if self.curve.autonomous else s
        key, known = (start, ds), self._taps
        if key in known:
            return known[key]
        made = self._make_taps(start, ds)
        # A thread may be reading: entries are added, but none is taken away; a new
        # table takes the place of one that is full.
        if len(known) < self.kept:
            known[key] = made
        else:
            self._taps = {key: made}
        return made

    def _make_taps(self, s: float, ds: float) -> tuple[Taps, ...]:
        shift1, shift2 = self.shifts(s, ds)
        if self.positive:
            return (*flux_taps(shift1, self.order), *flux_taps(shift2, self.order))
        return shift_taps(shift1, self.order), shift_taps(shift2, self.order)
