"""Fibres laid on a raster: every piece of a fibre counted where it lies, in integers.

A piece of a fibre is straight; it has one unit of length, however short its chord. A
unit is 2³⁶ counts. What the piece leaves in the pixels that it crosses are differences
of its length up to the crossings, rounded to counts: they sum up to the unit, and
sums of integers do not depend on their order. An image is therefore the same for any
number of threads, and length is conserved to the last count.
"""

import math
from typing import Any, NamedTuple

from numba import prange

from fpsolve._kernels.compiling import njit
from fpsolve._kernels.paths import LANES

# Counts of one piece: rounding moves less than 1e-11 of a piece to the pixel beside it.
UNIT_BITS = 36
UNIT = 1 << UNIT_BITS
# What is counted in a pixel: length, and of it the shares of τ₁τ₁ and of τ₁τ₂.
N_COUNTED = 3
# Tallies of a worker: units and counts outside of the image, pieces beyond the reach.
OUTSIDE, REST, BEYOND, N_TALLIES = 0, 1, 2, 3


class Raster(NamedTuple):
    """Pixels as the kernels see them; lengths are in pixels.

    Attributes
    ----------
    per_length : float
        Pixels per unit of length.
    lead : float
        The corner of a fibre lies this length ahead of ξ along the tangent.
    first_column : int
        Of the image; earlier columns are outside.
    periodic : bool
        Whether what leaves the image across the belt comes back on its other side.
    """

    per_length: float
    lead: float
    first_column: int
    periodic: bool


class Nozzles(NamedTuple):
    """Where the nozzles are while fibres are laid.

    Attributes
    ----------
    curve : ndarray, shape (n_steps, 6)
        After every step the position of a nozzle that is in phase, and how much cos φ -
        1 and sin φ of its own phase φ add to it.
    places : ndarray, shape (3, n_fibres)
        Place across the belt, cos φ - 1 and sin φ of every fibre.
    reach : ndarray, shape (2, 2)
        Lowest and highest deviation from the place on the belt that moves steadily,
        along and across, up to which the window has margins.
    steady : ndarray, shape (n_steps,)
        That place along the belt.
    """

    curve: Any
    places: Any
    reach: Any
    steady: Any


@njit(cache=True, forceinline=True)
def count(row, column, amount, direction, image):
    """Counts of a part of a piece into its pixel."""
    image[row, column, 0] += amount
    image[row, column, 1] += int(amount * direction[0] + 0.5)
    image[row, column, 2] += math.floor(amount * direction[1] + 0.5)


@njit(cache=True, forceinline=True)
def row_of(row, n_rows, periodic):
    """The row of the image; -1 outside."""
    if periodic:
        return row % n_rows
    return row if 0 <= row < n_rows else -1


@njit(cache=True, error_model="numpy")
def lay_across(start, end, raster, direction, image):
    """A piece that crosses the edges of pixels; returns its counts outside."""
    (x0, y0), (x1, y1) = start, end
    dx, dy = x1 - x0, y1 - y0
    column, row = math.floor(x0), math.floor(y0)
    n_along = abs(math.floor(x1) - column)
    n_across = abs(math.floor(y1) - row)
    along, across = (1 if dx > 0 else -1), (1 if dy > 0 else -1)
    # The edge ahead lies at the upper end of a pixel where the piece goes up.
    ahead1, ahead2 = max(along, 0), max(across, 0)
    n_rows, n_columns = image.shape[0], image.shape[1]
    done, outside = 0, 0
    while True:
        share1 = (column + ahead1 - x0) / dx if n_along > 0 else math.inf
        share2 = (row + ahead2 - y0) / dy if n_across > 0 else math.inf
        reached = UNIT
        if n_along + n_across > 0:
            reached = int(min(min(share1, share2), 1.0) * UNIT + 0.5)
        amount = max(reached - done, 0)
        place = column - raster.first_column
        inside = row_of(row, n_rows, raster.periodic)
        if inside >= 0 and 0 <= place < n_columns:
            count(inside, place, amount, direction, image)
        else:
            outside += amount
        done += amount
        if n_along + n_across == 0:
            return outside
        if share1 <= share2:
            column, n_along = column + along, n_along - 1
        else:
            row, n_across = row + across, n_across - 1


@njit(cache=True, error_model="numpy")
def lay_piece(start, end, raster, image):
    """One piece of a fibre between two corners; returns its counts outside.

    Parameters
    ----------
    start, end : (float, float)
        Along and across the belt, in pixels from the corner of the first one.
    raster : Raster
    image : ndarray of int64, shape (n_rows, n_columns, 3)
        Rows lie across the belt and columns along it; counts are added.
    """
    (x0, y0), (x1, y1) = start, end
    dx, dy = x1 - x0, y1 - y0
    square = dx * dx + dy * dy
    # A chord that has no direction counts half in each.
    direction = 0.5, 0.0
    if square > 0:
        direction = dx * dx / square, dx * dy / square
    column, row = math.floor(x0), math.floor(y0)
    if column != math.floor(x1) or row != math.floor(y1):
        return lay_across(start, end, raster, direction, image)
    place = int(column) - raster.first_column
    inside = row_of(int(row), image.shape[0], raster.periodic)
    if inside >= 0 and 0 <= place < image.shape[1]:
        count(inside, place, UNIT, direction, image)
        return 0
    return UNIT


@njit(cache=True, error_model="numpy")
def lay_fibre(i, trace, nozzles, raster, corner, image):
    """The steps of one fibre of a trace; returns counts outside and pieces beyond."""
    place, cosine, sine = (
        nozzles.places[0, i],
        nozzles.places[1, i],
        nozzles.places[2, i],
    )
    scale, reach = raster.per_length, nozzles.reach
    x0, y0 = corner[0, i], corner[1, i]
    outside, beyond = 0, 0
    for j in range(trace.shape[0]):
        curve = nozzles.curve[j]
        eta1 = trace[j, 0, i] + curve[0] + cosine * curve[2] + sine * curve[4]
        eta2 = trace[j, 1, i] + curve[1] + cosine * curve[3] + sine * curve[5]
        from_belt = eta1 - nozzles.steady[j]
        if not (
            reach[0, 0] <= from_belt <= reach[0, 1]
            and reach[1, 0] <= eta2 <= reach[1, 1]
        ):
            beyond += 1
        x1 = (eta1 + raster.lead * trace[j, 2, i]) * scale
        y1 = (eta2 + place + raster.lead * trace[j, 3, i]) * scale
        outside += lay_piece((x0, y0), (x1, y1), raster, image)
        x0, y0 = x1, y1
    corner[0, i], corner[1, i] = x0, y0
    return outside, beyond


@njit(cache=True, parallel=True, error_model="numpy")
def lay_fibres(trace, nozzles, raster, corners, tallies, images):
    """Lay the steps of a trace; as many workers as there are images.

    Parameters
    ----------
    trace : ndarray, shape (n_steps, n_state, n_fibres)
        ξ1, ξ2, cos α and sin α first, after every step.
    nozzles : Nozzles
    raster : Raster
    corners : ndarray, shape (2, n_fibres)
        The last corner of every fibre in pixels; moved on.
    tallies : ndarray of int64, shape (n_workers, 3)
    images : ndarray of int64, shape (n_workers, n_rows, n_columns, 3)
    """
    n_workers, n_fibres = images.shape[0], trace.shape[2]
    for worker in prange(n_workers):
        for block in range(worker, (n_fibres + LANES - 1) // LANES, n_workers):
            for i in range(block * LANES, min((block + 1) * LANES, n_fibres)):
                outside, beyond = lay_fibre(
                    i, trace, nozzles, raster, corners, images[worker]
                )
                tallies[worker, OUTSIDE] += outside >> UNIT_BITS
                tallies[worker, REST] += outside & (UNIT - 1)
                tallies[worker, BEYOND] += beyond
