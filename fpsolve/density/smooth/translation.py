"""T: the exact translation in ξ at fixed angle and curvature."""

from __future__ import annotations

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.density.schemes.stencils import Taps
from fpsolve.density.schemes.translation import Translation
from fpsolve.grids.smooth import SmoothPhaseSpaceGrid
from fpsolve.model.smooth import SmoothLayDownModel

__all__ = ["SmoothTranslation"]


class SmoothTranslation(Translation):
    """∂ₛp + (τ(α) - γ'(s))·∇_ξ p = 0, the same for every curvature.

    As `Translation` of the basic model, for modes of shape
    (n1, n2, n_kappa, n_alpha): neighbouring angles of all of them are moved together.

    Parameters
    ----------
    model : SmoothLayDownModel
    grid : SmoothPhaseSpaceGrid
    order : int
        Number of points of the interpolation in each direction, even.
    """

    def __init__(
        self, model: SmoothLayDownModel, grid: SmoothPhaseSpaceGrid, order: int = 8
    ) -> None:
        super().__init__(model, grid.phase_space, order)
        self.n_kappa = grid.shape[3]

    def __call__(self, p: Array, s: float, ds: float, out: Array) -> None:
        """Advance the modes p from s to s + ds into `out`."""
        planes = (*p.shape[:2], -1)
        super().__call__(p.reshape(planes), s, ds, out.reshape(planes))

    def _make_taps(self, s: float, ds: float) -> tuple[Taps, ...]:
        return tuple(
            (first, np.tile(weights, (1, self.n_kappa)))
            for first, weights in super()._make_taps(s, ds)
        )
