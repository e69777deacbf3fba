"""Rings far out in which B is nowhere low, found by following its valleys."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.model.potentials.quadrature import lowest_nearby

__all__ = ["lowest_in_ring"]

Value = Callable[..., Array]

# Circles in a ring between r and 2r and as many as need be on either side; angles on
# each, and the valleys that are followed: the lowest of them.
_N_CIRCLES, _N_OUTSIDE = 8, 2
_N_ANGLES, _N_VALLEYS = 512, 16
# A valley is narrowed down to this part of the angle between two probes, eightfold at
# a time.
_N_ZOOMS, _N_PROBES = 8, 17


def lowest_in_ring(value: Value, radius: float) -> float:
    """About the least B between two circles of radii r and 2r, or below.

    The least value on a circle is that of its lowest valley, which is followed by
    scanning and zooming. Between circles B lies above the lines through two of these
    values if they are convex in r.
    """
    steps = np.arange(-_N_OUTSIDE, _N_CIRCLES + _N_OUTSIDE + 1) / _N_CIRCLES
    radii = radius * np.exp2(steps)
    profile = _lowest_on_circles(value, radii)
    inside = slice(_N_OUTSIDE, len(radii) - _N_OUTSIDE)
    return float(lowest_nearby(profile[None], radii, 1)[0, inside].min())


def _lowest_on_circles(value: Value, radii: Array) -> Array:
    step = 2 * math.pi / _N_ANGLES
    angles = np.broadcast_to(step * np.arange(_N_ANGLES), (len(radii), _N_ANGLES))
    values = _on_circles(value, radii[:, None], angles)
    ahead, behind = np.roll(values, -1, axis=1), np.roll(values, 1, axis=1)
    valleys = np.where((values <= ahead) & (values <= behind), values, np.inf)
    places = np.argsort(valleys, axis=1)[:, :_N_VALLEYS]
    centre = step * places
    window = step
    lowest = np.take_along_axis(values, places, axis=1)
    for _ in range(_N_ZOOMS):
        probes = centre[:, :, None] + window * np.linspace(-1.0, 1.0, _N_PROBES)
        found = _on_circles(value, radii[:, None, None], probes)
        at = np.argmin(found, axis=2)[:, :, None]
        centre = np.take_along_axis(probes, at, axis=2)[:, :, 0]
        lowest = np.minimum(lowest, np.take_along_axis(found, at, axis=2)[:, :, 0])
        window *= 2.0 / (_N_PROBES - 1)
    return np.asarray(lowest.min(axis=1))


def _on_circles(value: Value, radii: Array, angles: Array) -> Array:
    xi1, xi2 = np.broadcast_arrays(radii * np.cos(angles), radii * np.sin(angles))
    with np.errstate(all="ignore"):
        values = np.asarray(value(xi1.ravel(), xi2.ravel())).reshape(xi1.shape)
    # Nothing is known where B is NaN.
    return np.where(np.isnan(values), -np.inf, np.minimum(values, 1e60))
