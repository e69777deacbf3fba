"""What two implicit runs with ds and ds/2 say about the error of the step."""

from __future__ import annotations

import warnings

import numpy as np

from fpsolve._support.arrays import Array

__all__ = ["allowed_error", "relaxation_lengths"]


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


def allowed_error(s: Array, ds: float, gain: float) -> Array:
    """Error of u_{ds/2} relative to u_{ds/2} − u_{ds}, at s beyond the start."""
    n_steps = s / ds - ROUNDING
    late = np.where(n_steps > LAYER, gain, 1.0)
    return np.where(n_steps > FIRST_STEPS, late, FIRST_CHANGES)


def relaxation_lengths(entropy: Array, loss: Array, ds: float) -> Array:
    """τ = H/(−dH/ds): over how much s the entropy falls by 1/e; shape (n_recorded,).

    Zero where H is noise. So wide are the windows in which the largest change counts.

    Warns
    -----
    UserWarning
        If ds is longer than twice the time scale of the slowest mode.
    """
    known = (entropy > NOISE_LEVEL) & (loss > 0.0) & np.isfinite(loss)
    lengths = np.zeros_like(entropy)
    np.divide(entropy, loss, out=lengths, where=known)
    if known.any():
        # H falls at twice the rate of the slowest mode that is left.
        _check_step(ds, 0.5 / float(lengths[known].max()))
    return lengths


def _check_step(ds: float, gap: float) -> None:
    if not ds * gap <= LONGEST:
        warnings.warn(
            f"`ds` = {ds:g} is long: the slowest mode falls by "
            f"exp(-{ds * gap:.3g}) in a step, and the estimates of the extrapolated "
            f"run may be too small; take ds below {LONGEST / gap:.3g}.",
            UserWarning,
            stacklevel=7,
        )
