"""The limit of s error² of averages along paths, and the noise at which it is least."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fpsolve._support.arrays import Array

__all__ = ["SETTLED", "Minimum", "jackknife_error", "least_noise", "settled_slope"]

# s error² is taken as settled from this share of the longest average on.
SETTLED = 0.25
# A variance below this many standard errors may as well be zero.
_CLEAR = 3.0
_REACH = 2  # noises on either side of the least that the parabola uses


def settled_slope(s: Array, squared: Array) -> Array:
    """Limit v of s error² from the slope of s² error² ≈ v s − w, stationary start.

    The integral of f behaves as Brownian motion in the end. Increments of its square
    between neighbouring s are then uncorrelated with variance ∝ s₊² − s², so that the
    best linear estimate of v weights them with 1/(s₊ + s). Linear in `squared`.

    Parameters
    ----------
    s : ndarray, shape (n,)
        Ascending.
    squared : ndarray, shape (..., n)
        Squared errors of the averages up to s.

    Returns
    -------
    ndarray, shape (...)
    """
    settled = s >= SETTLED * s[-1]
    s, squared = s[settled], squared[..., settled]
    weights = 1 / (s[1:] + s[:-1])
    increments = np.diff(s * s * squared, axis=-1)
    return np.asarray(increments @ weights / (np.diff(s) @ weights))


@dataclass(frozen=True)
class Minimum:
    """Where an asymptotic variance is least as a function of the noise.

    Attributes
    ----------
    noise, standard_error : float
        NaN unless the trend is "interior".
    trend : str
        "interior"; "rising" or "falling" when the least value is at the smallest or
        the largest noise; "vanishing" when the variance cannot be told from zero.
    """

    noise: float
    standard_error: float
    trend: str


def least_noise(noises: Array, batches: Array) -> Minimum:
    """Vertex of a parabola through ln v against ln A, around the least v.

    The uncertainty adds, as squares, the jackknife over batches and half the change
    when the parabola uses three points instead of five: the second says how far the
    variance is from a parabola there.

    Parameters
    ----------
    noises : ndarray, shape (n,)
        Ascending.
    batches : ndarray, shape (n_batches, n)
        Asymptotic variances by independent batches of paths.
    """
    variance = batches.mean(axis=0)
    error = batches.std(axis=0, ddof=1) / math.sqrt(len(batches))
    if not np.all(variance > _CLEAR * error):
        return Minimum(math.nan, math.nan, "vanishing")
    least = int(np.argmin(variance))
    if least in (0, noises.size - 1):
        return Minimum(math.nan, math.nan, "falling" if least else "rising")
    wide = slice(max(least - _REACH, 0), least + _REACH + 1)
    narrow = slice(least - 1, least + 2)
    logarithms = np.log(noises)
    relative = error / variance

    def vertex(values: Array, window: slice) -> float:
        ln_v, weights = np.log(values[window]), 1 / relative[window]
        square, linear, _ = np.polyfit(logarithms[window], ln_v, 2, w=weights)
        return float(np.exp(-linear / (2 * square))) if square > 0 else math.nan

    place = vertex(variance, wide)
    left_out = np.array([vertex(one, wide) for one in all_but_one(batches)])
    bend = (place - vertex(variance, narrow)) / 2
    return Minimum(place, math.hypot(jackknife_error(left_out), bend), "interior")


def all_but_one(batches: Array) -> Array:
    """Means over all batches but one, for each one."""
    return np.asarray((batches.sum(axis=0) - batches) / (len(batches) - 1))


def jackknife_error(estimates: Array) -> Array:
    """Standard error from the estimates that leave out one batch each, axis 0."""
    n = len(estimates)
    deviation = estimates - estimates.mean(axis=0)
    return np.asarray(np.sqrt((n - 1) / n * np.square(deviation).sum(axis=0)))
