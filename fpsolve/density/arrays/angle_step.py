"""R½ D R½ as products with matrices: to the modes in α, turned, and back."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.density.arrays.blocks import in_blocks
from fpsolve.density.arrays.library import Foreign, Library
from fpsolve.density.schemes.rotation import RotationDiffusion

__all__ = ["AngleStep"]

# Steps whose matrices are held: what an extrapolation leaves is made anew.
_KEPT = 1


class Frame(NamedTuple):
    """To the modes of each row in the frame of its ∇B, and back.

    Attributes
    ----------
    forward : array, shape (n_alpha, 2M)
        cos mα and −sin mα, m < M = n_alpha/2; in the place of sin 0 stands (−1)^k.
    backward : array, shape (2M, n_alpha)
        Its inverse.
    cosine, sine : array, shape (n_rows, M)
        Of m times the direction of ∇B.
    paired : array, shape (M,)
        Zero for m = 0, which has no sine, otherwise one.
    """

    forward: Foreign
    backward: Foreign
    cosine: Foreign
    sine: Foreign
    paired: Foreign


class AngleStep:
    """R½ D R½ of a `RotationDiffusion`, with its matrices, on the device.

    p ← factor · F⁻¹ e^{−imφ} M(|∇B|) e^{imφ} F p for every row: the same numbers as on
    the host but for the rounding of sums.

    Parameters
    ----------
    kick : RotationDiffusion
        Not `positive`.
    library : Library
    """

    def __init__(self, kick: RotationDiffusion, library: Library) -> None:
        self.kick, self.library = kick, library
        self.frame = Frame(*(library.array(one) for one in frame_of(kick)))
        self.turn = library.compiled(turned)
        self._made: dict[float, tuple[Foreign, ...]] = {}
        self._factors: dict[float, Foreign] = {}

    def __call__(self, planes: Foreign, s: float, ds: float) -> Foreign:
        """Return planes (n_alpha, n1, n2), advanced from s to s + ds."""
        factor = self.factor(s, ds)
        return self.turn(planes, self.frame, *self.tables(ds), factor)

    def tables(self, ds: float) -> tuple[Foreign, ...]:
        """What is left of the (−1)^k, and the blocks for the step ds."""
        known = self._made
        if ds in known:
            return known[ds]
        table = self.kick.table(ds)
        unmatched = np.zeros(self.kick.grid.shape[2] // 2)
        unmatched[0] = table.damping
        array = self.library.array
        made = (array(unmatched), *(array(one) for one in in_blocks(table)))
        # A new table takes the place of the old: a thread may be reading that.
        self._made = {**(known if len(known) < _KEPT else {}), ds: made}
        return made

    def factor(self, s: float, ds: float) -> Foreign:
        """Reaction of the balanced form on a belt that moves, (n_rows,); else None."""
        kick = self.kick
        if not kick.balanced or kick.model.curve.fixed:
            return None
        if not kick.model.curve.autonomous:
            return self.library.array(kick.reaction(s, ds))
        if ds not in self._factors:
            self._factors = {ds: self.library.array(kick.reaction(0.0, ds))}
        return self._factors[ds]


def frame_of(kick: RotationDiffusion) -> tuple[Array, ...]:
    """The arrays of a `Frame`."""
    n = kick.grid.shape[2]
    mode, cell = np.arange(n // 2), np.arange(n)
    # mα = π m (2k + 1)/n, brought into one period while it is an integer: exact.
    angle = np.pi / n * ((2 * cell[:, None] + 1) * mode % (2 * n))
    forward = np.stack([np.cos(angle), -np.sin(angle)], axis=1)
    forward[:, 1, 0] = 1.0 - 2.0 * (cell % 2)
    norm = np.full((n // 2, 2), 2.0 / n).T
    norm[:, 0] = 1.0 / n
    backward = (forward * norm).reshape(n, n).T
    direction = np.arctan2(kick.direction[1], kick.direction[0])
    phase = direction[:, None] * mode
    paired = np.minimum(mode, 1.0)
    return forward.reshape(n, n), backward, np.cos(phase), np.sin(phase), paired


def turned(
    xp: Any, planes: Foreign, frame: Frame, unmatched: Foreign, rows: Foreign,
    place_of: Foreign, coefficients: Foreign, matrices: Foreign, factor: Foreign,
) -> Foreign:  # fmt: skip
    """The angle step of all rows; planes (n_alpha, n1, n2)."""
    shape, n_modes = planes.shape, frame.paired.shape[0]
    columns = xp.reshape(planes, (shape[0], -1))
    spectrum = xp.reshape(xp.matmul(columns.T, frame.forward), (-1, 2, n_modes))
    even, odd = spectrum[:, 0, :], spectrum[:, 1, :]
    real = even * frame.cosine - odd * frame.sine
    imaginary = even * frame.sine + odd * frame.cosine * frame.paired
    modes = xp.take(xp.stack([real, imaginary], axis=1), rows, axis=0)
    moved = xp.take(combined(xp, modes, coefficients, matrices), place_of, axis=0)
    real, imaginary = moved[:, 0, :], moved[:, 1, :]
    even = real * frame.cosine + imaginary * frame.sine
    # The unmatched mode does not turn, and is damped only.
    beside = odd * unmatched
    odd = imaginary * frame.cosine * frame.paired - real * frame.sine + beside
    spectrum = xp.reshape(xp.stack([even, odd], axis=1), (-1, 2 * n_modes))
    if factor is not None:
        spectrum = spectrum * factor[:, None]
    return xp.reshape(xp.matmul(frame.backward.T, spectrum.T), shape)


def combined(
    xp: Any, modes: Foreign, coefficients: Foreign, matrices: Foreign
) -> Foreign:
    """Σ_q coefficients[r, q] modes[r] matrices[q] of every row of every block."""
    n_blocks, size, _, n_nodes, _ = coefficients.shape
    n_modes = matrices.shape[2]
    source = xp.reshape(modes, (n_blocks, size, 2, 1, n_modes))
    # Exact matrices have weight one.
    source = source if n_nodes == 1 else source * coefficients
    source = xp.reshape(source, (n_blocks, 2 * size, n_nodes * n_modes))
    return xp.reshape(xp.matmul(source, matrices), (-1, 2, n_modes))
