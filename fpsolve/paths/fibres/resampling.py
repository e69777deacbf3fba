"""Points at equal distances of arclength on the spline through other points."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array, check_finite_numbers
from fpsolve._support.checks import check_positive

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

__all__ = ["resampled"]

# Nodes by which the length of one piece of the spline is integrated; with as many the
# quadrature is exact to a part of 1e-6 even where the speed changes by half of itself.
N_NODES = 5
# Newton steps from a linear guess to the parameter of an arclength.
N_STEPS = 4
# Points below which there is no spline through every other one.
FEWEST = 8


def resampled(
    points: Array, ds: float, s: ArrayLike | None = None
) -> tuple[Array, float]:
    """Points at arclengths iΔs of the cubic spline through points, and their error.

    The error is the root mean square distance to the curve through every other point
    at the same arclengths: of order 4 in the distance of the points where the fibre is
    smooth, and no lower than the error wherever finer points are better.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
    ds : float
    s : array_like, shape (n,), optional
        Arclengths, where they are known.

    Raises
    ------
    ValueError
        If the points are fewer than eight, two neighbours the same, arclengths do not
        increase, or the fibre has no two points at such a distance.
    """
    ds = check_positive("ds", ds)
    if not len(points) >= FEWEST:
        raise ValueError(
            f"`points` must be at least {FEWEST} to be resampled, got {len(points)}."
        )
    known = None if s is None else _checked_arclengths(s, len(points))
    fine, coarse = _Arc(points, known), _Arc(*_every_other(points, known))
    # The coarse one ends earlier where the number of points is even.
    n = int(np.floor(fine.length / ds * (1 + 1e-9))) + 1
    places = np.minimum(ds * np.arange(n), fine.length)
    here = fine.at(places)
    both = places <= coarse.length
    apart = here[both] - coarse.at(places[both])
    return here, float(np.sqrt(np.mean(np.sum(apart**2, axis=1))))


def _every_other(points: Array, s: Array | None) -> tuple[Array, Array | None]:
    return points[::2], None if s is None else s[::2]


def _checked_arclengths(s: ArrayLike, n: int) -> Array:
    array = check_finite_numbers("s", s)
    if array.shape != (n,) or not (np.diff(array) > 0).all():
        raise ValueError(
            f"`s` must be {n} increasing arclengths, one for each point, got shape "
            f"{array.shape}."
        )
    shifted: Array = array - array[0]
    return shifted


class _Arc:
    """A cubic spline through points, by its arclength.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
    s : ndarray, shape (n,), or None
        Arclengths of the points; by default those of the spline itself.
    """

    def __init__(self, points: Array, s: Array | None) -> None:
        from scipy.interpolate import CubicSpline

        steps = np.hypot(*np.diff(points, axis=0).T)
        if not steps.min() > 0:
            index = int(np.argmin(steps))
            raise ValueError(
                "`points` must differ from their neighbours, got the same point at "
                f"{index} and {index + 1}."
            )
        self.known = s is not None
        self.knots = np.append(0.0, np.cumsum(steps)) if s is None else s
        self.spline: CubicSpline = CubicSpline(self.knots, points)
        self.speed: CubicSpline = self.spline.derivative()
        between = self._lengths(self.knots[:-1], self.knots[1:])
        self.arclengths = self.knots if s is not None else np.append(
            0.0, np.cumsum(between)
        )  # fmt: skip
        self.length = float(self.arclengths[-1])

    def at(self, places: Array) -> Array:
        """Points at these arclengths, (n, 2)."""
        if self.known:
            return np.asarray(self.spline(places))
        piece = np.searchsorted(self.arclengths, places, side="right") - 1
        piece = np.clip(piece, 0, len(self.knots) - 2)
        t = np.interp(places, self.arclengths, self.knots)
        for _ in range(N_STEPS):
            short = places - self.arclengths[piece] - self._lengths(
                self.knots[piece], t
            )  # fmt: skip
            t = t + short / np.hypot(*self.speed(t).T)
        return np.asarray(self.spline(t))

    def _lengths(self, begin: Array, end: Array) -> Array:
        """Lengths of the spline between parameters, by Gauss's rule."""
        nodes, weights = np.polynomial.legendre.leggauss(N_NODES)
        half = 0.5 * (end - begin)
        t = begin[:, None] + half[:, None] * (1 + nodes)
        speed = np.linalg.norm(self.speed(t), axis=-1)
        return np.asarray(half * (speed @ weights))
