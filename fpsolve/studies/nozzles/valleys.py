"""Where a pattern is weakest: a scan, and a search in its deepest valleys."""

from __future__ import annotations

import itertools

import numpy as np
from scipy.optimize import minimize

from fpsolve._support.arrays import Array
from fpsolve.errors import ToleranceError
from fpsolve.studies.nozzles.patterns import Patterns

__all__ = ["RESOLUTION", "best_of", "range_of", "scanned", "searched"]

# Logarithms of the free numbers that are not told from each other.
RESOLUTION = 0.01
# Valleys that are searched, and patterns for each at most.
MOST_VALLEYS, MOST_PATTERNS = 3, 40


def scanned(patterns: Patterns, low: Array, high: Array, n: int) -> list[Array]:
    """Patterns on a grid, n points along every axis; its valleys, deepest first.

    A valley is a point without a better neighbour, those across corners included.

    Raises
    ------
    ToleranceError
        If none of them is known.
    """
    axes = [np.linspace(*ends, n) for ends in zip(low, high, strict=True)]
    shape = (n,) * len(axes)
    squares = np.empty(shape)
    for place in np.ndindex(shape):
        y = np.array([axis[k] for axis, k in zip(axes, place, strict=True)])
        squares[place] = patterns(y).square
    if not np.isfinite(squares).any():
        raise ToleranceError(
            np.inf, patterns.asked.tolerance,
            "no pattern of the scan is known: raise `tolerance`, or lower the bounds, "
            "so that nozzles move more slowly than the fibre",
        )  # fmt: skip
    valleys = [place for place in np.ndindex(shape) if is_valley(squares, place)]
    valleys.sort(key=lambda place: float(squares[place]))
    return [
        np.array([axis[k] for axis, k in zip(axes, place, strict=True)])
        for place in valleys[:MOST_VALLEYS]
    ]


def is_valley(squares: Array, place: tuple[int, ...]) -> bool:
    """Whether no neighbour is lower."""
    if not np.isfinite(squares[place]):
        return False
    around = itertools.product((-1, 0, 1), repeat=len(place))
    beside = (tuple(np.add(place, step)) for step in around)
    inside = (one for one in beside if all(0 <= k < len(squares) for k in one))
    return all(squares[place] <= squares[one] for one in inside)


def searched(
    patterns: Patterns, start: Array, low: Array, high: Array, step: Array
) -> None:
    """The simplex of Nelder and Mead from a valley, until it is lost in the errors.

    It ends where its corners differ by less than the error of the pattern at the start
    and lie within the resolution of each other, or after MOST_PATTERNS.
    """
    inwards = np.where(start + step <= high, step, -step)
    corners = np.vstack([start, start + np.diag(inwards)])
    lost = max(patterns(start).square_error, np.finfo(float).tiny)
    minimize(
        lambda y: patterns(y).square, start, method="Nelder-Mead",
        bounds=list(zip(low, high, strict=True)),
        options={"initial_simplex": corners, "xatol": RESOLUTION, "fatol": lost,
                 "maxfev": MOST_PATTERNS},
    )  # fmt: skip


def best_of(patterns: Patterns) -> Array:
    """The point whose pattern varies least."""
    squares = [at.square for at in patterns.known.values()]
    return np.asarray(patterns.points[int(np.argmin(squares))])


def range_of(patterns: Patterns) -> Array:
    """From where to where the optimum may be, (2, parameter).

    The box of all points that errors do not tell from the best one, to the points next
    to it on every axis.
    """
    points, found = patterns.points, list(patterns.known.values())
    lowest = min(found, key=lambda at: at.square)
    most = lowest.square + lowest.square_error
    near = np.array([at.square - at.square_error <= most for at in found])
    ends = []
    for values in points.T:
        inner = values[near].min(), values[near].max()
        below, above = values[values < inner[0]], values[values > inner[1]]
        ends.append((
            below.max() if below.size else inner[0],
            above.min() if above.size else inner[1],
        ))  # fmt: skip
    return np.array(ends).T
