"""O: what a fibre does that no force turns, exactly."""

from __future__ import annotations

import math

import numpy as np

from fpsolve._kernels.smooth import mix
from fpsolve._support.arrays import Array
from fpsolve.density.smooth.curvature_modes import CurvatureModes
from fpsolve.grids.smooth import SmoothPhaseSpaceGrid
from fpsolve.model.smooth import SmoothLayDownModel

__all__ = ["Relaxation", "covariance"]

# Waves of the highest frequency that the cells hold are held, whatever the rounding.
_EDGE = 1e-9


class Relaxation:
    """∂ₛp + κ ∂_α p = ∂_κ(κ p)/R + (K²/2) ∂_κκ p, the flow of (κ, α) without a force.

    A wave exp(i(mα + kκ)) of the density is the value at (m, k) of its characteristic
    function, and that moves: after the step ds it is what it was at
    q = k e^{−ds/R} + m R (1 − e^{−ds/R}), times that of the Gaussian of `covariance`.
    What is between the frequencies of the cells comes from the sum over the cells,
    which is exact for what the cells hold: there is no error in ds, and none in κ but
    where the density is not resolved or is cut. The result is one matrix in κ for
    every mode in α. Conserves: mass, to rounding. Drops: waves beyond the cells.

    Parameters
    ----------
    model : SmoothLayDownModel
    grid : SmoothPhaseSpaceGrid
    """

    def __init__(self, model: SmoothLayDownModel, grid: SmoothPhaseSpaceGrid) -> None:
        self.model, self.grid = model, grid
        self.modes = CurvatureModes(grid)
        self.numbers = np.arange(grid.shape[2] // 2)
        angles = np.outer(grid.alpha, self.numbers)
        waves = np.stack([np.cos(angles), -np.sin(angles)], axis=2)
        self.forward = waves.reshape(grid.shape[2], -1)
        doubled = np.where(self.numbers == 0, 1.0, 2.0)[:, None] / grid.shape[2]
        scaled = waves * doubled
        self.backward = np.ascontiguousarray(scaled.reshape(grid.shape[2], -1).T)
        self._tables: dict[float, Array] = {}

    def __call__(self, u: Array, s: float, ds: float, out: Array) -> None:
        """Advance the modes u by ds into `out`; shape (n1, n2, n_kappa, n_alpha)."""
        rows = (-1, *u.shape[2:])
        mix(
            u.reshape(rows), self.forward, self.matrices(ds), self.backward,
            out.reshape(rows),
        )  # fmt: skip

    def matrices(self, ds: float) -> Array:
        """One matrix for every mode in α, of real and imaginary parts of all in κ."""
        if ds not in self._tables:
            # A new dictionary takes the place of the old: a thread may be reading that.
            self._tables = {**self._tables, ds: self._made(ds)}
        return self._tables[ds]

    def _made(self, ds: float) -> Array:
        flows = np.array([self._flow(m, ds) for m in self.numbers.tolist()])
        flows = self.modes.forward @ flows @ self.modes.backward
        across = flows.swapaxes(1, 2)
        upper = np.concatenate([across.real, across.imag], axis=2)
        lower = np.concatenate([-across.imag, across.real], axis=2)
        return np.ascontiguousarray(np.concatenate([upper, lower], axis=1))

    def _flow(self, mode: int, ds: float) -> Array:
        """The matrix of one mode in α from cells in κ to cells; complex."""
        kappa, n = self.grid.kappa, self.grid.shape[3]
        length = self.model.relaxation_length
        faded = math.exp(-ds / length)
        numbers = np.arange(-(n // 2), n // 2 + 1)
        wave = np.pi / self.grid.kappa_half_width * numbers
        before = wave * faded + mode * length * -math.expm1(-ds / length)
        heat = covariance(self.model, ds)
        spread = wave**2 * heat[0, 0] + 2 * mode * wave * heat[0, 1]
        damping = np.exp(-0.5 * (spread + mode**2 * heat[1, 1]))
        # What comes from beyond the cells is not held; of an even number of waves the
        # last is one with its mirror image.
        held = np.abs(before) <= (1.0 + _EDGE) * np.pi / self.grid.spacing[3]
        share = np.where(2 * np.abs(numbers) == n, 0.5, 1.0) * held
        analysis = np.exp(-1j * np.outer(before, kappa)) * (share * damping)[:, None]
        flow: Array = np.exp(1j * np.outer(kappa, wave)) @ analysis / n
        return flow


def covariance(model: SmoothLayDownModel, ds: float) -> Array:
    """Covariance K² ∫₀^{ds} g gᵀ du of (κ, α), g = (e^{−u/R}, R(1 − e^{−u/R})).

    Without cancellation where ds is small against R.
    """
    length, ratio = model.relaxation_length, ds / model.relaxation_length
    scale = model.curvature_noise**2 * length
    grown = -math.expm1(-ratio)
    both = 0.5 * grown**2
    if ratio > 0.05:
        square = ratio - grown - both
    else:
        square = sum(
            (-ratio) ** n * (2.0 - 2.0 ** (n - 1)) / math.factorial(n)
            for n in range(12, 2, -1)
        )
    kappa = -0.5 * math.expm1(-2 * ratio)
    both *= length
    return scale * np.array([[kappa, both], [both, length**2 * square]])
