"""What two implicit runs with ds and ds/2 say about the error of the step."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve.evolution.richardson import error_of_series

__all__ = ["StepErrors"]

Array = NDArray[np.float64]

# A start may be rougher than anything that follows: its fast modes have no expansion in
# ds. Within so many steps the error is the whole change, whatever the order, and right
# at the start three times that; so measured for point masses, narrow Gaussians and
# random starts against exp(sQ).
LAYER, FIRST_STEPS, FIRST_CHANGES = 12, 2, 3.0
# Steps longer than this over the spectral gap may be covered by no difference at all:
# at two they were for all starts tried, at five not.
LONGEST = 2.0
# Below, a relative entropy is rounding, and its rate with it.
NOISE_LEVEL = 1e-13
# Steps are counted up to rounding.
ROUNDING = 1e-6


class StepErrors:
    """Errors of u_{ds/2}, which bound those of the extrapolated values.

    The windows in which the largest change counts are as long as the entropy needs to
    fall by 1/e, τ = H/(−dH/ds) at every s.

    Parameters
    ----------
    fine : Relaxation
    ds : float
        The longer step.
    gain : float
        Of the order; see `fpsolve.evolution.richardson`.

    Warns
    -----
    UserWarning
        If ds is longer than twice the time scale of the slowest mode.
    """

    def __init__(self, fine: Any, ds: float, gain: float) -> None:
        self.fine, self.ds, self.gain = fine, ds, gain
        entropy, loss = fine.relative_entropy, fine.entropy_dissipation
        known = (entropy > NOISE_LEVEL) & (loss > 0.0) & np.isfinite(loss)
        self.reach = np.zeros_like(entropy)
        np.divide(entropy, loss, out=self.reach, where=known)
        self._check_step(known)

    def of_series(self, change: Array) -> Array:
        """At every record, from u_{ds/2} − u_{ds}; shape (n_recorded,)."""
        s = self.fine.s
        return error_of_series(s, change, self.reach, self._allowed(s))

    def of_saved(self, change: Array) -> Array:
        """Σ |error| at every save, from differences of shape (n_saved, n)."""
        total: Array = np.abs(change).sum(axis=1)
        return self._allowed(self.fine.saved_s) * total

    def _allowed(self, s: Array) -> Array:
        """The error relative to the change."""
        n_steps = (s - self.fine.s[0]) / self.ds - ROUNDING
        late = np.where(n_steps > LAYER, self.gain, 1.0)
        return np.where(n_steps > FIRST_STEPS, late, FIRST_CHANGES)

    def _check_step(self, known: NDArray[np.bool_]) -> None:
        if not known.any():
            return
        # H falls at twice the rate of the slowest mode that is left.
        gap = 0.5 / float(self.reach[known].max())
        if not self.ds * gap <= LONGEST:
            warnings.warn(
                f"`ds` = {self.ds:g} is long: the slowest mode falls by "
                f"exp(-{self.ds * gap:.3g}) in a step, and the estimates of the "
                f"extrapolated run may be too small; take ds below "
                f"{LONGEST / gap:.3g}.",
                UserWarning,
                stacklevel=7,
            )
