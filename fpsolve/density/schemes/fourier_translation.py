"""T by the trigonometric interpolant: the exact shift of what the grid resolves."""

from __future__ import annotations

from typing import Any

import numpy as np

from fpsolve._kernels.fourier_shift import ANGLES, Direction, shift_fourier
from fpsolve._support.arrays import Array
from fpsolve.density.schemes.stencils import unit_sum
from fpsolve.density.schemes.translation import Translation
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.fibre import FibreModel

# Two shifts, half and whole, of each of eight levels of an extrapolation.
_KEPT = 16


class FourierTranslation(Translation):
    """∂ₛp + (τ(α) − γ′(s))·∇_ξ p = 0, exact for trigonometric polynomials in ξ.

    One circulant matrix per angle and direction: every Fourier mode of the periodic
    box turns by its phase, the unmatched mode of an even number of cells by the cosine
    of it. Shifts compose, T(s) T(−s) = 1, but in that mode, so repeated shifts leave
    no interpolation error of their own. Keeps the mass to rounding, and constants. Not
    positive: beside features that the cells do not resolve it oscillates over the
    whole box.

    Parameters
    ----------
    model : FibreModel
        Only `curve` is used.
    grid : PhaseSpaceGrid

    References
    ----------
    The interpolant and its matrices as in [Tre00]_.
    """

    def __init__(self, model: FibreModel, grid: PhaseSpaceGrid) -> None:
        super().__init__(model, grid)
        self.kept = _KEPT
        n1, n2, n = grid.shape[:3]
        self.along1 = Direction(n1, n2 * n, n2, n, n)
        self.along2 = Direction(n2, n, n1, n2 * n, n)

    def __call__(self, p: Array, s: float, ds: float, out: Array) -> None:
        """Advance p from s to s + ds into `out`."""
        weights1, weights2 = self._remembered_taps(s, ds)
        flat = out.reshape(-1)
        shift_fourier(np.ascontiguousarray(p).reshape(-1), weights1, self.along1, flat)
        shift_fourier(flat, weights2, self.along2, flat)

    def _make_taps(self, s: float, ds: float) -> tuple[Any, ...]:
        shifts, sizes = self.shifts(s, ds), self.grid.shape[:2]
        return tuple(
            blocked(shift_weights(shift, n))
            for shift, n in zip(shifts, sizes, strict=True)
        )


def shift_weights(shift: Array, n: int) -> Array:
    """First columns c of the circulants, p(x − shift) ≈ Σ_d c_d p(x − d); in parts.

    Of an odd n as they are, shape (1, n, n_alpha); of an even n what acts on sums and
    on differences of halves, (c_d ± c_{d + n/2})/2, shape (2, n/2, n_alpha).
    """
    phase = np.exp(-2j * np.pi / n * np.arange(n // 2 + 1)[:, None] * shift)
    if n % 2 == 0:
        phase[-1] = phase[-1].real
    column: Array = np.fft.irfft(phase, n, axis=0)
    if n % 2:
        return unit_sum(column)[None]
    first, second = column[: n // 2], column[n // 2 :]
    return np.stack([unit_sum(first + second), first - second]) / 2


def blocked(weights: Array) -> Array:
    """Weights of eight angles at a time; shape (n_blocks, parts, half, 8)."""
    parts, half, n_alpha = weights.shape
    n_blocks = -(-n_alpha // ANGLES)
    padded = np.pad(weights, ((0, 0), (0, 0), (0, n_blocks * ANGLES - n_alpha)))
    shaped = padded.reshape(parts, half, n_blocks, ANGLES)
    return np.ascontiguousarray(shaped.transpose(2, 0, 1, 3))
