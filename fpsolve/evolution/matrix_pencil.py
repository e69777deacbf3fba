"""Exponents of a series that is a sum of exponentials, by the matrix pencil.

A relative entropy that decays is Σ c_jk e^{(λ_j + λ_k) s} as soon as it is small. A
line through its logarithm follows whichever of these terms is the largest on the
window, while the slowest may still be coming up. The values of a run are exact to many
digits, so that they tell more terms than one.
"""

from __future__ import annotations

import numpy as np

from fpsolve._support.arrays import Array

__all__ = ["slowest_exponents"]


# Values of the resampled series: enough for ten terms, little to compute with.
N_VALUES = 61
# Numbers of terms that are tried.
ORDERS = (3, 4, 5, 6, 7, 8)
# What a sum of so many terms may miss of the series, relative, to be believed.
MISFIT = 0.05
# A term counts if it has this share of the largest at the end of the window.
SHARE = 1e-2
# Roots this small are terms that are gone after one value.
GONE = 1e-3


def slowest_exponents(s: Array, logarithms: Array, rate: float) -> Array:
    """Decay rates of the slowest term, one for every number of terms that fits.

    Parameters
    ----------
    s, logarithms : ndarray, shape (n,)
        Places, ascending, and ln of the values.
    rate : float
        Roughly that of the decay, which is taken out before: a series that falls over
        decades would be fitted at its beginning only.

    Returns
    -------
    ndarray
        May be empty.

    References
    ----------
    [HS90]_.
    """
    places = np.linspace(s[0], s[-1], N_VALUES)
    flat = np.exp(np.interp(places, s, logarithms + rate * (s - s[-1])))
    flat /= np.abs(flat).max()
    spacing = places[1] - places[0]
    window = N_VALUES // 3 + 1
    shifted = np.lib.stride_tricks.sliding_window_view(flat, window).T
    left = np.linalg.svd(shifted, full_matrices=False)[0]
    found = [_slowest(flat, left[:, :order], spacing) for order in ORDERS]
    return np.array([rate + one for one in found if one is not None])


def _slowest(flat: Array, left: Array, spacing: float) -> float | None:
    """Least decay rate among the terms of a subspace; None if they do not fit."""
    roots = np.linalg.eigvals(np.linalg.lstsq(left[:-1], left[1:], rcond=None)[0])
    roots = roots[np.abs(roots) > GONE].astype(complex)
    powers = roots ** np.arange(flat.size)[:, None]
    if not (roots.size and np.isfinite(powers).all()):
        return None
    shares = np.linalg.lstsq(powers, flat.astype(complex), rcond=None)[0]
    misfit = np.linalg.norm(powers @ shares - flat) / np.linalg.norm(flat)
    if not misfit < MISFIT:
        return None
    at_end = np.abs(shares * powers[-1])
    there = at_end > SHARE * at_end.max()
    return float(np.min(-np.log(np.abs(roots[there]))) / spacing)
