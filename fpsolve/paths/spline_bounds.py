"""Upper bounds of a periodic quintic spline on the cells around its knots.

A cell reaches half a spacing to either side of its centre, where the knots are. Values
of the spline there are averages of coefficients with weights that sum to one: of the
B-spline coefficients of the 7 knots around, of those after every knot interval has been
halved, and of the Bernstein coefficients of both halves. The largest coefficient is
therefore a bound, ever sharper in this order, and ever more expensive.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from math import comb

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from scipy.interpolate import BSpline

from fpsolve._support.arrays import Array

__all__ = ["SPLINE_ORDER", "bounded_by", "cell_averages", "negative_share"]


SPLINE_ORDER = 5
# Coefficients along one axis on which the spline on a cell depends.
REACH = 3
AROUND = np.arange(-REACH, REACH + 1)
# Weights by which halved knot intervals take the old coefficients.
HALVING = np.array([comb(SPLINE_ORDER + 1, k) for k in range(SPLINE_ORDER + 2)]) / 32
# Cells whose Bernstein coefficients are held at a time.
GROUP = 256
# Points along each side of a cell at which the sign is looked at.
N_POINTS = 3


def bounded_by(coefficients: Array, bounds: Array) -> Array:
    """`bounds`, raised where the spline on a cell might exceed them.

    Parameters
    ----------
    coefficients : ndarray, shape (n1, n2, n3)
        B-spline coefficients at the centres of the cells.
    bounds : ndarray, shape (n1, n2, n3)
        Hoped for; they are kept bit for bit where they hold.
    """
    raised = bounds.copy()
    suspect = largest_around(coefficients) > bounds
    if suspect.any():
        suspect &= largest_around(halved(coefficients))[::2, ::2, ::2] > bounds
    cells = np.argwhere(suspect)
    for first in range(0, len(cells), GROUP):
        group = cells[first : first + GROUP]
        at = tuple(group.T)
        raised[at] = np.maximum(bounds[at], largest_bernstein(coefficients, group))
    return raised


def negative_share(coefficients: Array) -> float:
    """Negative over positive mass of the spline, from 27 points of every cell."""
    positive = negative = 0.0
    for values in at_points(coefficients):
        positive += float(values[values > 0].sum())
        negative -= float(values[values < 0].sum())
    return negative / positive


def cell_averages(coefficients: Array) -> Array:
    """Averages over cells of the spline, cut off below zero.

    Exact but for what is cut off, which is taken at 27 points of every cell.
    """
    weights = averaging_weights()
    averages = coefficients
    for axis in range(3):
        averages = ndimage.correlate1d(averages, weights, axis=axis, mode="wrap")
    for values in at_points(coefficients):
        averages += np.maximum(-values, 0.0) / N_POINTS**3
    return averages


def at_points(coefficients: Array) -> Iterator[Array]:
    """Values at one point of every cell, for all points in turn."""
    weights = [spline_weights(offset / N_POINTS) for offset in (-1, 0, 1)]
    for first in weights:
        along1 = ndimage.correlate1d(coefficients, first, axis=0, mode="wrap")
        for second in weights:
            along2 = ndimage.correlate1d(along1, second, axis=1, mode="wrap")
            for third in weights:
                yield ndimage.correlate1d(along2, third, axis=2, mode="wrap")


def largest_around(coefficients: Array) -> Array:
    """Largest of the coefficients on which a cell depends."""
    largest: Array = ndimage.maximum_filter(coefficients, AROUND.size, mode="wrap")
    return largest


def halved(coefficients: Array) -> Array:
    """Coefficients of the same spline on knots half as far apart."""
    for axis in range(coefficients.ndim):
        fine = np.zeros((*coefficients.shape, 2))
        for part in (0, 1):
            for k in range(-1, 2 + part):
                weight = HALVING[REACH + part - 2 * k]
                fine[..., part] += weight * np.roll(coefficients, -k, axis)
        shape = list(coefficients.shape)
        shape[axis] *= 2
        coefficients = np.moveaxis(fine, -1, axis + 1).reshape(shape)
    return coefficients


def largest_bernstein(coefficients: Array, cells: NDArray[np.intp]) -> Array:
    """Largest Bernstein coefficient on each of some cells, shape (n,)."""
    n = len(cells)
    place1, place2, place3 = (
        (AROUND[:, None] + cells[:, axis]) % coefficients.shape[axis]
        for axis in range(3)
    )
    block = coefficients[place1[:, None, None], place2[:, None], place3[None]]
    matrix, size = bernstein_matrix(), AROUND.size
    rows = matrix.shape[0]
    along1 = (matrix @ block.reshape(size, -1)).reshape(rows, size, size * n)
    along2 = np.matmul(matrix, along1).reshape(rows * rows, size, n)
    largest: Array = np.matmul(matrix, along2).max(axis=(0, 1))
    return largest


@cache
def bernstein_matrix() -> Array:
    """Bernstein coefficients on both halves of a cell, from the 7 coefficients."""
    t = np.linspace(0.0, 1.0, SPLINE_ORDER + 1)
    numbers = range(SPLINE_ORDER + 1)
    basis = np.stack(
        [comb(SPLINE_ORDER, j) * t**j * (1 - t) ** (SPLINE_ORDER - j) for j in numbers],
        axis=1,
    )
    halves = [
        np.stack([spline_weights(start + x / 2) for x in t]) for start in (-0.5, 0.0)
    ]
    found = [np.linalg.solve(basis, values) for values in halves]
    return np.asarray(np.concatenate(found), dtype=np.float64)


def averaging_weights() -> Array:
    """Weights of the 7 coefficients in the average over the cell."""
    knots = np.arange(-REACH, REACH + 1, dtype=np.float64)
    spline = BSpline.basis_element(knots, extrapolate=False)
    ends = [(max(-0.5 - k, -REACH), min(0.5 - k, REACH)) for k in AROUND]
    return np.array([float(spline.integrate(*pair)) for pair in ends])


def spline_weights(offset: float) -> Array:
    """Weights of the 7 coefficients in the value at an offset from the centre."""
    knots = np.arange(-REACH, REACH + 1, dtype=np.float64)
    spline = BSpline.basis_element(knots, extrapolate=False)
    return np.asarray(np.nan_to_num(spline(offset - AROUND)), dtype=np.float64)
