"""Shifts of the trigonometric interpolant along one direction, by angle.

A shift along n periodic cells is a circulant matrix, different for every angle. Of an
even n the halves of a column are added and subtracted first: the sum is shifted by a
circulant of n/2, the difference by one that changes its sign when it wraps, which is
half the work. Four columns and eight angles are shifted together, so that a weight is
read once for four results that stay in registers; they are copied to a contiguous
buffer, whatever the direction.
"""

from typing import NamedTuple

import numpy as np
from numba import prange

from fpsolve._kernels.compiling import njit
from fpsolve._kernels.lanes import LANES, put, spread, take

COLUMNS = 4
ANGLES = 2 * LANES
WIDTH = COLUMNS * ANGLES


class Direction(NamedTuple):
    """Where the cells along one direction lie in the flat array.

    Attributes
    ----------
    n, stride : int
        Cells along the direction, and how far apart.
    n_beside, stride_beside : int
        Columns beside each other, and how far apart.
    n_alpha : int
        Angles, which are neighbours.
    """

    n: int
    stride: int
    n_beside: int
    stride_beside: int
    n_alpha: int


@njit(cache=True, error_model="numpy")
def gather(flat, at, direction, n_angles, columns):
    """columns[i, 8c + k] = flat[at[c] + i stride + k]; zero beyond the angles."""
    for i in range(direction.n):
        for c in range(COLUMNS):
            start = at[c] + i * direction.stride
            if n_angles == ANGLES:
                put(columns, (i, c * ANGLES), take(flat, (start,)))
                put(columns, (i, c * ANGLES + LANES), take(flat, (start + LANES,)))
            else:
                for k in range(n_angles):
                    columns[i, c * ANGLES + k] = flat[start + k]


@njit(cache=True, error_model="numpy")
def scatter(columns, at, direction, n_angles, flat):
    """The inverse of `gather`."""
    for i in range(direction.n):
        for c in range(COLUMNS):
            start = at[c] + i * direction.stride
            if n_angles == ANGLES:
                put(flat, (start,), take(columns, (i, c * ANGLES)))
                put(flat, (start + LANES,), take(columns, (i, c * ANGLES + LANES)))
            else:
                for k in range(n_angles):
                    flat[start + k] = columns[i, c * ANGLES + k]


@njit(cache=True, error_model="numpy")
def halve(columns, sources):
    """Sum and difference of the halves, each continued to the left by a period.

    columns (n, 32); sources (2, n, 32), or (1, 2n, 32) for a whole column. The second
    is continued with its sign changed.
    """
    parts, double = sources.shape[:2]
    half = double // 2
    for i in range(half):
        for c in range(0, WIDTH, LANES):
            first = take(columns, (i, c))
            if parts == 1:
                put(sources, (0, i, c), first)
                put(sources, (0, half + i, c), first)
            else:
                second = take(columns, (half + i, c))
                total, apart = first + second, first - second
                put(sources, (0, i, c), total)
                put(sources, (0, half + i, c), total)
                put(sources, (1, i, c), -apart)
                put(sources, (1, half + i, c), apart)


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def convolve(source, weights, place, out):
    """out[8c + k] = Σ_t weights[t, k] source[place − t, 8c + k], four c at once."""
    a = b = c = d = e = f = g = h = spread(0.0)
    for t in range(weights.shape[0]):
        w, v = take(weights, (t, 0)), take(weights, (t, 4))
        at = place - t
        a = a + w * take(source, (at, 0))
        e = e + v * take(source, (at, 4))
        b = b + w * take(source, (at, 8))
        f = f + v * take(source, (at, 12))
        c = c + w * take(source, (at, 16))
        g = g + v * take(source, (at, 20))
        d = d + w * take(source, (at, 24))
        h = h + v * take(source, (at, 28))
    put(out, (0,), a)
    put(out, (4,), e)
    put(out, (8,), b)
    put(out, (12,), f)
    put(out, (16,), c)
    put(out, (20,), g)
    put(out, (24,), d)
    put(out, (28,), h)


@njit(cache=True, error_model="numpy")
def shift_columns(sources, weights, moved, columns):
    """Shift the parts and put them together; sources (parts, 2 half, 32).

    weights (parts, half, 8); moved (2, 32) scratch; columns (parts half, 32).
    """
    parts, half = weights.shape[:2]
    for i in range(half):
        convolve(sources[0], weights[0], half + i, moved[0])
        if parts == 2:
            convolve(sources[1], weights[1], half + i, moved[1])
        for c in range(0, WIDTH, LANES):
            total = take(moved, (0, c))
            if parts == 1:
                put(columns, (i, c), total)
            else:
                apart = take(moved, (1, c))
                put(columns, (i, c), total + apart)
                put(columns, (half + i, c), total - apart)


@njit(cache=True, parallel=True, error_model="numpy")
def shift_fourier(flat, weights, direction, out):
    """Shift along one direction; flat, out (n_cells,), which may be the same array.

    weights (n_blocks, parts, half, 8), a block of eight angles after the other, with
    parts · half = n. Threads share columns, whose sums do not depend on them.
    """
    n_blocks, parts, half, _ = weights.shape
    n_beside = direction.n_beside
    for block in prange((n_beside + COLUMNS - 1) // COLUMNS):
        at = np.empty(COLUMNS, np.int64)
        columns = np.zeros((direction.n, WIDTH))
        sources = np.empty((parts, 2 * half, WIDTH))
        moved = np.empty((2, WIDTH))
        for angles in range(n_blocks):
            first = angles * ANGLES
            n_angles = min(ANGLES, direction.n_alpha - first)
            for c in range(COLUMNS):
                # The last column stands for those that are missing.
                column = min(block * COLUMNS + c, n_beside - 1)
                at[c] = column * direction.stride_beside + first
            gather(flat, at, direction, n_angles, columns)
            halve(columns, sources)
            shift_columns(sources, weights[angles], moved, columns)
            scatter(columns, at, direction, n_angles, out)
