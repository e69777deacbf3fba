"""The series of a run, from sums that are taken where the density lies."""

from __future__ import annotations

from typing import Any

import numpy as np

from fpsolve.density.arrays.form import DeviceDensity
from fpsolve.density.arrays.library import Foreign, on_host
from fpsolve.density.recorder import Record, Recorder
from fpsolve.grids.diagnostics import DIFFERENCE
from fpsolve.grids.row_sums import SMALLEST, RowFunctionals

__all__ = ["ArrayRecorder"]


class ArrayRecord(Record):
    """One step of a run; the density is copied to the host for those who ask for it."""

    def functionals(self) -> RowFunctionals:
        """Sums over α, shape (7, n1, n2), copied from the device."""
        density: Any = self.density
        known: Any = self.recorder
        sums = density.library.compiled(plane_sums)
        rows = sums(density.planes, *known.constants(density))
        return RowFunctionals.of_rows(on_host(rows), self.grid)


class ArrayRecorder(Recorder):
    """A `Recorder` of densities on a device."""

    kind_of_record = ArrayRecord
    _constants: tuple[Foreign, ...] | None = None

    def constants(self, density: DeviceDensity) -> tuple[Foreign, ...]:
        """cos α, sin α and 1/(ratio r), or None, on the device of the density."""
        if self._constants is None:
            array, alpha = density.library.array, self.grid.alpha
            inverse = None if self.inverse is None else array(self.inverse)
            self._constants = array(np.cos(alpha)), array(np.sin(alpha)), inverse
        return self._constants


def plane_sums(
    xp: Any, p: Foreign, cosine: Foreign, sine: Foreign, inverse: Foreign
) -> Foreign:
    """What `row_functionals` leaves, of p (n_alpha, n1, n2); shape (7, n1, n2).

    Σ_k of p, p cos α, p sin α, (δ√p)²; min_k p; Σ_k of max(−p, 0), p ln(p inverse), or
    zero where there is no `inverse`.
    """
    flat = xp.reshape(p, (p.shape[0], -1))
    turned = [xp.reshape(one @ flat, p.shape[1:]) for one in (cosine, sine)]
    zero, total = xp.zeros_like(p), xp.sum(p, axis=0)
    below = xp.sum(xp.where(p < 0.0, -p, zero), axis=0)
    above = xp.where(p < 0.0, zero, p)
    slopes = xp.sum(staggered_difference(xp, xp.sqrt(above)) ** 2, axis=0)
    information = xp.zeros_like(total)
    if inverse is not None:
        q = above * inverse
        logarithm = xp.log(xp.where(q < SMALLEST, xp.full_like(q, SMALLEST), q))
        information = xp.sum(above * logarithm, axis=0)
    lowest = xp.min(p, axis=0)
    return xp.stack([total, *turned, slopes, lowest, below, information], axis=0)


def staggered_difference(xp: Any, q: Foreign) -> Foreign:
    """δq at k + ½ along the periodic first axis, of order eight, unit spacing."""
    pairs = (
        weight * (xp.roll(q, -1 - j, axis=0) - xp.roll(q, j, axis=0))
        for j, weight in enumerate(DIFFERENCE)
    )
    return sum(pairs)
