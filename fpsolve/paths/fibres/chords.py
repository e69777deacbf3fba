"""Angle and curvature of a fibre by finite differences of its points.

Of points η_i at arclengths iΔs: the chord angle α_i is that of η_{i+1} − η_i,
unwrapped, at the middle of the chord, and κ_i = (α_{i+1} − α_i)/Δs at the point between
two chords. The same operator serves data and surrogate, so that what it does to a curve
cancels.
"""

from __future__ import annotations

import math

import numpy as np

from fpsolve._support.arrays import Array

__all__ = ["check_steps", "check_turns", "chord_angles", "chord_curvatures", "turns_of"]

# Root mean square turn from chord to chord above which a turn beyond π, which cannot be
# told from one the other way round, is no longer 4.5 standard deviations off.
LARGEST_TURN = 0.7
# Chords are shorter than the fibre between their ends, by κ²Δs²/24 of it: below this
# share of Δs the fibre turns within a step, and its angle cannot be known.
SHORTEST_CHORD = 0.8
# Standard deviations of the points by which a chord may be longer than Δs.
MOST_DEVIATIONS = 6.0


def chord_angles(eta: Array) -> Array:
    """α of the chords of a fibre, unwrapped.

    Parameters
    ----------
    eta : ndarray, shape (n, ..., 2)
        Points along the first axis, any number of fibres along those between.

    Returns
    -------
    ndarray, shape (n - 1, ...)
    """
    chords = np.diff(eta, axis=0)
    wrapped = np.arctan2(chords[..., 1], chords[..., 0])
    return np.asarray(np.unwrap(wrapped, axis=0))


def chord_curvatures(alpha: Array, ds: float) -> Array:
    """κ = Δα/Δs between chords; shape (n - 2, ...) for n - 1 angles."""
    return np.asarray(np.diff(alpha, axis=0) / ds)


def turns_of(eta: Array) -> Array:
    """The angle from chord to chord, in (-π, π]; shape (n - 2, ...)."""
    chords = np.diff(eta, axis=0)
    (x0, y0), (x1, y1) = (
        (part[..., 0], part[..., 1]) for part in (chords[:-1], chords[1:])
    )
    return np.asarray(np.arctan2(x0 * y1 - y0 * x1, x0 * x1 + y0 * y1))


def check_steps(pieces: tuple[Array, ...], ds: float, position_error: float) -> None:
    """Raise ValueError unless the points may lie Δs apart along a fibre."""
    chords = np.concatenate([np.hypot(*np.diff(piece, axis=0).T) for piece in pieces])
    longest = float(chords.max())
    allowed = ds * (1 + 1e-9) + MOST_DEVIATIONS * math.sqrt(2) * position_error
    if not longest <= allowed:
        raise ValueError(
            f"`ds` must be at least the distance of neighbouring points, got {ds:g} "
            f"and points {longest:.6g} apart: no fibre is shorter than its chord. Pass "
            "the `position_error` or the unit of the points, or let "
            "`FibreCurve.from_points` find the arclength of points that are not "
            "equally far apart."
        )
    mean = float(chords.mean())
    if not mean >= SHORTEST_CHORD * ds:
        raise ValueError(
            f"`ds` must be about the distance of neighbouring points, got {ds:g} and "
            f"points {mean:.6g} apart on average: the fibre turns within a step, or "
            "the points are in another unit; take points that are closer together."
        )


def check_turns(turns: Array) -> float:
    """The root mean square turn; ValueError if it is too large for unwrapping α."""
    largest = float(np.sqrt(np.mean(np.square(turns))))
    if not largest <= LARGEST_TURN:
        raise ValueError(
            "`ds` must be so short that the fibre turns by little from chord to chord, "
            f"got a root mean square turn of {largest:.3g}, above {LARGEST_TURN:g}: "
            "the angle cannot be unwrapped. Take points that are closer together, or, "
            "if the points scatter, smoother ones."
        )
    return largest
