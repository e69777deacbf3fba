"""Values at the feet of characteristics, and how they change along a displacement.

Feet are given in index units (cell i is at i), periodic in all three directions.
Lagrange polynomials of 4 points (cubic) or 6 points (quintic) in each direction. The
values around a foot are read once: they give the interpolant and its derivative along
the displacement together. Everything but this reading is done for four angles at once.
"""

from typing import NamedTuple

import numpy as np
from numba import prange
from numba.extending import register_jitable

from fpsolve._kernels.compiling import njit
from fpsolve._kernels.lanes import (
    LANES,
    below,
    fused,
    larger,
    put,
    smaller,
    spread,
    take,
    transposed,
)

# Part of a cell that is rounding of a foot.
ON_A_NODE = 1e-9
MOST_POINTS = 6
# Angles together: what is known of their stencils stays in the nearest cache. It is one
# flat array, each quantity in a row of its own, whose place the compiler thus knows.
CHUNK = 32
# Nodes that stencils begin with, by direction, and weights by direction and node.
NODES, VALUES, AXIS = 0, 3 * CHUNK, MOST_POINTS * CHUNK
# Weights of the central differences at the two nodes around a foot, by direction, each
# with the displacement.
SLOPES = 21 * CHUNK
# Interpolated values, their changes, displacements in α, tilts, and ones.
VALUE, CHANGE, TURN, TILT, ONES = (row * CHUNK for row in range(27, 32))
# Of every cell, with the weights of the first two directions: values at the nodes of
# the third, of six the last four once more; and the same of the changes.
SUMS, CELL = 32 * CHUNK, 2 * LANES
MOVED = SUMS + CELL * CHUNK
N_SCRATCH = MOVED + CELL * CHUNK


class Displacement(NamedTuple):
    """δ = η b ds² between the two feet of a cell and the middle.

    speed1, speed2 (n_alpha,) its ξ-part in cells; the α-part in cells is
    angular · (force1 sin α − force2 cos α) with forces (n1, n2). slope1, slope2
    (n_alpha,) are the ξ-part in units of length where h stands for e^{B} p, zero where
    it is p itself.
    """

    speed1: np.ndarray
    speed2: np.ndarray
    force1: np.ndarray
    force2: np.ndarray
    cosine: np.ndarray
    sine: np.ndarray
    angular: float
    slope1: np.ndarray
    slope2: np.ndarray


class Rows(NamedTuple):
    """Values in one flat array, and where the rows of every pair of nodes begin.

    The row of the nodes i and j begins at starts1[i] + starts2[j].
    """

    flat: np.ndarray
    starts1: np.ndarray
    starts2: np.ndarray


@register_jitable(fastmath={"contract"}, error_model="numpy", forceinline=True)
def cubic_weights(f):
    """Lagrange weights of the nodes −1, 0, 1, 2 at 0 ≤ f < 1, four at once."""
    one, two, half = spread(1.0), spread(2.0), spread(0.5)
    a, c, d = f + one, f - one, f - two
    inner, outer = c * d, a * f
    return (
        -f * inner * spread(1 / 6), a * inner * half,
        -outer * d * half, outer * c * spread(1 / 6),
    )  # fmt: skip


@register_jitable(fastmath={"contract"}, error_model="numpy", forceinline=True)
def quintic_weights(f):
    """Lagrange weights of the nodes −2, …, 3 at 0 ≤ f < 1, four at once."""
    a, b, c = f + spread(2.0), f + spread(1.0), f - spread(1.0)
    d, e = f - spread(2.0), f - spread(3.0)
    left, right, middle = a * b, d * e, f * c
    return (
        -b * middle * right * spread(1 / 120), a * middle * right * spread(1 / 24),
        -left * c * (right * spread(1 / 12)), left * f * (right * spread(1 / 12)),
        -left * middle * e * spread(1 / 24), left * middle * d * spread(1 / 120),
    )  # fmt: skip


@njit(cache=True, error_model="numpy")
def following(index, n):
    """index + 1, periodic: a comparison costs a tenth of a division."""
    return index + 1 if index + 1 < n else 0


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def wrapped(cell, n):
    """The whole number `cell` modulo n; in floats, an integer division is slow.

    0 where there is no such number (NaN, or beyond 2⁵³, where the remainder is lost):
    an index outside the array would read memory that is not ours.
    """
    index = int(cell - n * np.floor(cell / n))
    return index if 0 <= index < n else 0


@register_jitable(fastmath={"contract"}, error_model="numpy", forceinline=True)
def wrapped_lanes(cell, n):
    """As `wrapped`, four at once: any index in the array where there is no number."""
    n = spread(1.0 * n)
    index = fused(-n, below(cell / n), cell)
    # The first of two stays where the second is NaN.
    return smaller(n - spread(1.0), larger(spread(0.0), index))


@register_jitable(fastmath=False, error_model="numpy", forceinline=True)
def weigh(places, moves, n, axis, n_points, w):
    """Nodes and weights of one direction, at `places` of a row, moved by `moves`.

    places, moves (n_cells,) in cells; n cells in the direction `axis`.
    """
    values, slopes = VALUES + axis * AXIS, SLOPES + 2 * axis * CHUNK
    for block in range((places.size + LANES - 1) // LANES):
        k = min(block * LANES, places.size - LANES)
        place, move = take(places, (k,)), take(moves, (k,))
        cell = below(place)
        first = cell - spread(0.5 * n_points - 1.0)
        put(w, (NODES + axis * CHUNK + k,), wrapped_lanes(first, n))
        f = place - cell
        if n_points == 4:
            four = cubic_weights(f)
            for a in range(4):
                put(w, (values + a * CHUNK + k,), four[a])
        else:
            six = quintic_weights(f)
            for a in range(6):
                put(w, (values + a * CHUNK + k,), six[a])
        # Central differences at the two nodes around the place, between them by a line.
        half = spread(0.5) * move
        after = f * half
        put(w, (slopes + k,), half - after)
        put(w, (slopes + CHUNK + k,), after)


@register_jitable(fastmath=False, error_model="numpy", forceinline=True)
def four_rows(rows, start, j):
    """Values at four neighbouring nodes of each of the rows of j, …, j + 3."""
    flat, starts2 = rows.flat, rows.starts2
    return (
        take(flat, (start + starts2[j],)), take(flat, (start + starts2[j + 1],)),
        take(flat, (start + starts2[j + 2],)), take(flat, (start + starts2[j + 3],)),
    )  # fmt: skip


@register_jitable(fastmath=False, error_model="numpy", forceinline=True)
def weighted(weights, k, nodes, w):
    """Σ weights · nodes, with one weight of cell k for each of four nodes."""
    total = spread(w[weights + k]) * nodes[0]
    total = fused(spread(w[weights + CHUNK + k]), nodes[1], total)
    total = fused(spread(w[weights + 2 * CHUNK + k]), nodes[2], total)
    return fused(spread(w[weights + 3 * CHUNK + k]), nodes[3], total)


@register_jitable(fastmath=False, error_model="numpy", forceinline=True)
def weighted_six(weights, k, nodes, w):
    """The same of six nodes."""
    total = weighted(weights, k, nodes[:4], w)
    total = fused(spread(w[weights + 4 * CHUNK + k]), nodes[4], total)
    return fused(spread(w[weights + 5 * CHUNK + k]), nodes[5], total)


@register_jitable(fastmath=False, error_model="numpy", forceinline=True)
def difference(weights, k, nodes, w):
    """Central differences at the second and the third of four nodes, weighted."""
    total = spread(w[weights + k]) * (nodes[2] - nodes[0])
    return fused(spread(w[weights + CHUNK + k]), nodes[3] - nodes[1], total)


@register_jitable(fastmath=False, error_model="numpy", forceinline=True)
def gather_four(rows, i, j, third, k, w):
    """Sums over 4² rows of the stencil of cell k, at the four nodes from `third`."""
    starts1 = rows.starts1
    a = four_rows(rows, starts1[i] + third, j)
    b = four_rows(rows, starts1[i + 1] + third, j)
    c = four_rows(rows, starts1[i + 2] + third, j)
    d = four_rows(rows, starts1[i + 3] + third, j)
    second, slopes = VALUES + AXIS, SLOPES + 2 * CHUNK
    planes = (
        weighted(second, k, a, w), weighted(second, k, b, w),
        weighted(second, k, c, w), weighted(second, k, d, w),
    )  # fmt: skip
    moved = (
        difference(slopes, k, a, w), difference(slopes, k, b, w),
        difference(slopes, k, c, w), difference(slopes, k, d, w),
    )  # fmt: skip
    change = weighted(VALUES, k, moved, w) + difference(SLOPES, k, planes, w)
    put(w, (SUMS + CELL * k,), weighted(VALUES, k, planes, w))
    put(w, (MOVED + CELL * k,), change)


@register_jitable(fastmath=False, error_model="numpy", forceinline=True)
def six_plane(rows, start, j, k, w):
    """Of the rows of six nodes: their weighted sum, and what it changes by."""
    first, last = four_rows(rows, start, j), four_rows(rows, start, j + 2)
    nodes = (first[0], first[1], first[2], first[3], last[2], last[3])
    return (
        weighted_six(VALUES + AXIS, k, nodes, w),
        difference(SLOPES + 2 * CHUNK, k, nodes[1:5], w),
    )


@register_jitable(fastmath=False, error_model="numpy", forceinline=True)
def gather_six(rows, i, j, third, k, w):
    """Sums over 6² rows of the stencil of cell k, at the six nodes from `third`."""
    starts1 = rows.starts1
    for part in range(2):
        at = third + 2 * part
        a, moved_a = six_plane(rows, starts1[i] + at, j, k, w)
        b, moved_b = six_plane(rows, starts1[i + 1] + at, j, k, w)
        c, moved_c = six_plane(rows, starts1[i + 2] + at, j, k, w)
        d, moved_d = six_plane(rows, starts1[i + 3] + at, j, k, w)
        e, moved_e = six_plane(rows, starts1[i + 4] + at, j, k, w)
        f, moved_f = six_plane(rows, starts1[i + 5] + at, j, k, w)
        moved = (moved_a, moved_b, moved_c, moved_d, moved_e, moved_f)
        change = difference(SLOPES, k, (b, c, d, e), w)
        change = change + weighted_six(VALUES, k, moved, w)
        value = weighted_six(VALUES, k, (a, b, c, d, e, f), w)
        put(w, (SUMS + CELL * k + LANES * part,), value)
        put(w, (MOVED + CELL * k + LANES * part,), change)


@register_jitable(fastmath=False, error_model="numpy", forceinline=True)
def copy_across(rows, i, j, third, n_alpha, n_points, copy):
    """The stencil of a cell that crosses α = 0, together in copy (6, 6, 6)."""
    for a in range(n_points):
        for b in range(n_points):
            start, node = rows.starts1[i + a] + rows.starts2[j + b], third
            for c in range(n_points):
                copy[a, b, c] = rows.flat[start + node]
                node = following(node, n_alpha)


@register_jitable(fastmath=False, error_model="numpy", forceinline=True)
def gather(rows, n_cells, n_alpha, n_points, copied, copy, w):
    """Sums over the first two directions of `n_cells` stencils."""
    for k in range(n_cells):
        i, j = int(w[NODES + k]), int(w[NODES + CHUNK + k])
        third = int(w[NODES + 2 * CHUNK + k])
        if third + n_points > n_alpha:
            copy_across(rows, i, j, third, n_alpha, n_points, copy)
            if n_points == 4:
                gather_four(copied, 0, 0, 0, k, w)
            else:
                gather_six(copied, 0, 0, 0, k, w)
        elif n_points == 4:
            gather_four(rows, i, j, third, k, w)
        else:
            gather_six(rows, i, j, third, k, w)


@register_jitable(fastmath=False, error_model="numpy", forceinline=True)
def along(node, k, nodes, total, w):
    """total + Σ weights · nodes over nodes of the third direction, of four cells."""
    for c in range(len(nodes)):
        weight = take(w, (VALUES + 2 * AXIS + (node + c) * CHUNK + k,))
        total = fused(weight, nodes[c], total)
    return total


@register_jitable(fastmath=False, error_model="numpy", forceinline=True)
def columns(first, w):
    """Sums of four cells from `first`, by node."""
    return transposed(
        take(w, (first,)), take(w, (first + CELL,)),
        take(w, (first + 2 * CELL,)), take(w, (first + 3 * CELL,)),
    )  # fmt: skip


@register_jitable(fastmath=False, error_model="numpy", forceinline=True)
def combine(n_cells, n_points, w):
    """Values of the cells, and their changes by the displacement, of their sums."""
    for block in range((n_cells + LANES - 1) // LANES):
        k = min(block * LANES, n_cells - LANES)
        values, moved = columns(SUMS + CELL * k, w), columns(MOVED + CELL * k, w)
        value = along(0, k, values, spread(0.0), w)
        change = along(0, k, moved, spread(0.0), w)
        if n_points == MOST_POINTS:
            # Of six nodes the last four come second, of which two are new.
            last = columns(SUMS + CELL * k + LANES, w)
            value = along(4, k, last[2:], value, w)
            moved = columns(MOVED + CELL * k + LANES, w)
            change = along(4, k, moved[2:], change, w)
            values = (values[1], values[2], values[3], last[2])
        before = take(w, (SLOPES + 4 * CHUNK + k,))
        after = take(w, (SLOPES + 5 * CHUNK + k,))
        change = fused(before, values[2] - values[0], change)
        change = fused(after, values[3] - values[1], change)
        put(w, (VALUE + k,), value)
        put(w, (CHANGE + k,), change)


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def nodes_around(x):
    """First node of those around x and their number: 2, or 1 if x is a node itself.

    A foot that rounding puts on one side of a node is not to be told from one on the
    other, or the reflection of a run would be limited by other values.
    """
    first = np.floor(x)
    if x - first <= ON_A_NODE:
        return first, 1
    if first + 1.0 - x <= ON_A_NODE:
        return first + 1.0, 1
    return first, 2


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def range_around(h, x, y, z):
    """Least and largest value of the eight nodes around (x, y, z).

    Four, two or one of them if the point lies on a face, an edge or a node.
    """
    n1, n2, n3 = h.shape
    (first1, some1), (first2, some2) = nodes_around(x), nodes_around(y)
    first3, some3 = nodes_around(z)
    i = wrapped(first1, n1)
    lowest = np.inf
    highest = -np.inf
    for _ in range(some1):
        j = wrapped(first2, n2)
        for _ in range(some2):
            k = wrapped(first3, n3)
            for _ in range(some3):
                lowest = min(lowest, h[i, j, k])
                highest = max(highest, h[i, j, k])
                k = following(k, n3)
            j = following(j, n2)
        i = following(i, n1)
    return lowest, highest


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def limit(h, places, w):
    """Values of cells, with and without their changes, held in the range around feet.

    The quasi-monotone limiter of Bermejo and Staniforth. places (3, n_cells).
    """
    for k in range(places.shape[1]):
        lowest, highest = range_around(h, places[0, k], places[1, k], places[2, k])
        value = min(max(w[VALUE + k], lowest), highest)
        room = min(highest - value, value - lowest)
        w[VALUE + k] = value
        w[CHANGE + k] = min(max(w[CHANGE + k], -room), room)


@register_jitable(fastmath=False, error_model="numpy", forceinline=True)
def settle(factors, limited, w, changes, out):
    """Finish cells: out = factor · value, changes = factor · |change − tilt · value|.

    factors, out (n_cells,), changes also (0,) where they are not wanted; `limited`
    changes are no larger than what they change.
    """
    for block in range((out.size + LANES - 1) // LANES):
        k = min(block * LANES, out.size - LANES)
        value, factor = take(w, (VALUE + k,)), take(factors, (k,))
        change = fused(-take(w, (TILT + k,)), value, take(w, (CHANGE + k,)))
        change = larger(change, -change)
        if limited:
            change = smaller(change, larger(value, -value))
        put(out, (k,), value * factor)
        if changes.size > 0:
            put(changes, (k,), change * factor)


@njit(cache=True, error_model="numpy")
def row_starts(n, length):
    """Where the rows of the nodes 0, 1, … of a direction begin, beyond its end too."""
    starts = np.empty(n + MOST_POINTS, np.int64)
    for i in range(starts.size):
        starts[i] = (i % n) * length
    return starts


@njit(cache=True, parallel=True, error_model="numpy")
def interpolate_at_feet(h, feet, growth, displacement, n_points, limited, changes, out):
    """out = growth · h(foot), and by how much that changes along a displacement.

    Transport along characteristics with a reaction. The change is growth times
    |δ·∇h − (δ·∇B) h|, the derivative of e^{∓δ·∇B} h(foot ± δ): one of the two moved
    feet has more than the middle by that, the other less, but for terms of second
    order in δ. `limited` values lie in the range of the nodes around the foot, and so
    do the moved ones.

    Parameters
    ----------
    h, out : ndarray, shape (n1, n2, n_alpha)
    feet : ndarray, shape (3, n1, n2, n_alpha)
        In index units.
    growth : ndarray, shape (n1, n2, n_alpha)
        Or (1, 1, 1), where nothing grows.
    displacement : Displacement
    n_points : int
        4 or 6.
    limited : bool
    changes : ndarray, shape (n1, n2, n_alpha)
        Or (0, 0, 0), where they are not wanted.
    """
    n1, n2, n_alpha = h.shape
    rows = Rows(h.reshape(-1), row_starts(n1, n2 * n_alpha), row_starts(n2, n_alpha))
    speed1, speed2, force1, force2, cosine, sine, angular, slope1, slope2 = displacement
    grows, moves = growth.size > 1, changes.size > 0
    for i in prange(n1):
        copy = np.empty((MOST_POINTS, MOST_POINTS, MOST_POINTS))
        copied = Rows(copy.reshape(-1), row_starts(6, 36), row_starts(6, 6))
        w = np.ones(N_SCRATCH)
        for j in range(n2):
            f1, f2 = force1[i, j], force2[i, j]
            for chunk in range((n_alpha + CHUNK - 1) // CHUNK):
                # At least as many as are treated at once; some of them again.
                first = min(chunk * CHUNK, n_alpha - LANES)
                last = min((chunk + 1) * CHUNK, n_alpha)
                n_cells, places = last - first, feet[:, i, j, first:last]
                for k in range(n_cells):
                    angle = first + k
                    turn = f1 * sine[angle] - f2 * cosine[angle]
                    w[TURN + k] = angular * turn
                    w[TILT + k] = slope1[angle] * f1 + slope2[angle] * f2
                weigh(places[0], speed1[first:last], n1, 0, n_points, w)
                weigh(places[1], speed2[first:last], n2, 1, n_points, w)
                weigh(places[2], w[TURN : TURN + n_cells], n_alpha, 2, n_points, w)
                gather(rows, n_cells, n_alpha, n_points, copied, copy, w)
                combine(n_cells, n_points, w)
                if limited:
                    limit(h, places, w)
                settle(
                    growth[i, j, first:last] if grows else w[ONES : ONES + n_cells],
                    limited, w,
                    changes[i, j, first:last] if moves else w[:0],
                    out[i, j, first:last],
                )  # fmt: skip
