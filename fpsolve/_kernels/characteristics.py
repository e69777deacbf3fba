"""Interpolation at the feet of characteristics, and its mass adjustment.

Feet are given in index units (cell i is at i), periodic in all three directions.
Lagrange polynomials of 4 points (cubic) or 6 points (quintic) in each direction.
"""

from typing import NamedTuple

import numpy as np
from numba import prange

from fpsolve._kernels.compiling import njit

# Part of a cell that is rounding of a foot.
ON_A_NODE = 1e-9


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


@njit(cache=True, error_model="numpy")
def four_from(first, n):
    """Four consecutive periodic indices."""
    a = wrapped(first, n)
    b = following(a, n)
    c = following(b, n)
    return a, b, c, following(c, n)


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def cubic_weights(f):
    """Lagrange weights of the nodes −1, 0, 1, 2 at 0 ≤ f < 1."""
    a, c, d = f + 1.0, f - 1.0, f - 2.0
    return -f * c * d / 6.0, a * c * d / 2.0, -a * f * d / 2.0, a * f * c / 6.0


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def quintic_weights(f):
    """Lagrange weights of the nodes −2, …, 3 at 0 ≤ f < 1."""
    a, b, c, d, e = f + 2.0, f + 1.0, f - 1.0, f - 2.0, f - 3.0
    return (
        -b * f * c * d * e / 120.0,
        a * f * c * d * e / 24.0,
        -a * b * c * d * e / 12.0,
        a * b * f * d * e / 12.0,
        -a * b * f * c * e / 24.0,
        a * b * f * c * d / 120.0,
    )


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def plane_sums(plane, j, k, v):
    """Σ_b v[b] plane[j[b], k + c] for c = 0, …, 3, without wrapping k.

    Four sums over neighbouring addresses, which the compiler turns into one vector.
    """
    k = np.uint64(k)
    k1, k2, k3 = k + np.uint64(1), k + np.uint64(2), k + np.uint64(3)
    r0, r1, r2, r3 = plane[j[0]], plane[j[1]], plane[j[2]], plane[j[3]]
    return (
        v[0] * r0[k] + v[1] * r1[k] + v[2] * r2[k] + v[3] * r3[k],
        v[0] * r0[k1] + v[1] * r1[k1] + v[2] * r2[k1] + v[3] * r3[k1],
        v[0] * r0[k2] + v[1] * r1[k2] + v[2] * r2[k2] + v[3] * r3[k2],
        v[0] * r0[k3] + v[1] * r1[k3] + v[2] * r2[k3] + v[3] * r3[k3],
    )


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def wrapped_line(row, k, w):
    """Σ_c w[c] row[k[c]] for a stencil that crosses α = 0."""
    return w[0] * row[k[0]] + w[1] * row[k[1]] + w[2] * row[k[2]] + w[3] * row[k[3]]


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def wrapped_plane(plane, j, k, v, w):
    """Σ_b v[b] Σ_c w[c] plane[j[b], k[c]] over 4² points."""
    return (
        v[0] * wrapped_line(plane[j[0]], k, w)
        + v[1] * wrapped_line(plane[j[1]], k, w)
        + v[2] * wrapped_line(plane[j[2]], k, w)
        + v[3] * wrapped_line(plane[j[3]], k, w)
    )


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def value_cubic(h, x, y, z):
    """h interpolated at (x, y, z) in index units with 4³ points."""
    cell1, cell2, cell3 = np.floor(x), np.floor(y), np.floor(z)
    i = four_from(cell1 - 1.0, h.shape[0])
    j = four_from(cell2 - 1.0, h.shape[1])
    k = four_from(cell3 - 1.0, h.shape[2])
    u = cubic_weights(x - cell1)
    v = cubic_weights(y - cell2)
    w = cubic_weights(z - cell3)
    if k[3] != k[0] + 3:
        return (
            u[0] * wrapped_plane(h[i[0]], j, k, v, w)
            + u[1] * wrapped_plane(h[i[1]], j, k, v, w)
            + u[2] * wrapped_plane(h[i[2]], j, k, v, w)
            + u[3] * wrapped_plane(h[i[3]], j, k, v, w)
        )
    a = plane_sums(h[i[0]], j, k[0], v)
    b = plane_sums(h[i[1]], j, k[0], v)
    c = plane_sums(h[i[2]], j, k[0], v)
    d = plane_sums(h[i[3]], j, k[0], v)
    return (
        w[0] * (u[0] * a[0] + u[1] * b[0] + u[2] * c[0] + u[3] * d[0])
        + w[1] * (u[0] * a[1] + u[1] * b[1] + u[2] * c[1] + u[3] * d[1])
        + w[2] * (u[0] * a[2] + u[1] * b[2] + u[2] * c[2] + u[3] * d[2])
        + w[3] * (u[0] * a[3] + u[1] * b[3] + u[2] * c[3] + u[3] * d[3])
    )


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def line_quintic(row, k, w):
    """Σ_c w[c] row[k[c]] over six points."""
    return (
        w[0] * row[k[0]] + w[1] * row[k[1]] + w[2] * row[k[2]]
        + w[3] * row[k[3]] + w[4] * row[k[4]] + w[5] * row[k[5]]
    )  # fmt: skip


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def value_quintic(h, x, y, z):
    """h interpolated at (x, y, z) in index units with 6³ points."""
    cell1, cell2, cell3 = np.floor(x), np.floor(y), np.floor(z)
    n1, n2, n3 = h.shape
    u = quintic_weights(x - cell1)
    v = quintic_weights(y - cell2)
    w = quintic_weights(z - cell3)
    near = four_from(cell3 - 2.0, n3)
    fifth = following(near[3], n3)
    k = (near[0], near[1], near[2], near[3], fifth, following(fifth, n3))
    first2 = wrapped(cell2 - 2.0, n2)
    i = wrapped(cell1 - 2.0, n1)
    total = 0.0
    for a in range(6):
        plane = 0.0
        j = first2
        for b in range(6):
            plane += v[b] * line_quintic(h[i, j], k, w)
            j = following(j, n2)
        total += u[a] * plane
        i = following(i, n1)
    return total


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
def clipped(h, x, y, z, value):
    """value limited to the range of the eight nodes around (x, y, z).

    The quasi-monotone limiter of Bermejo and Staniforth; four, two or one of the nodes
    if the point lies on a face, an edge or a node.
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
    return min(max(value, lowest), highest)


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def value_at(h, x, y, z, n_points, limited):
    """h at (x, y, z) in index units; n_points 4 (cubic) or 6 (quintic)."""
    value = value_cubic(h, x, y, z) if n_points == 4 else value_quintic(h, x, y, z)
    return clipped(h, x, y, z, value) if limited else value


@njit(cache=True, parallel=True, fastmath={"contract"}, error_model="numpy")
def interpolate_at_feet(h, feet, growth, n_points, limited, out):
    """out = e^growth h(foot): transport along characteristics with a reaction.

    h, out (n1, n2, n_alpha); feet (3, n1, n2, n_alpha) in index units; growth
    (n1, n2, n_alpha), or (1, 1, 1) for none; n_points 4 or 6.
    """
    n1, n2, n_alpha = h.shape
    grows = growth.size > 1
    for i in prange(n1):
        for j in range(n2):
            for k in range(n_alpha):
                value = value_at(
                    h, feet[0, i, j, k], feet[1, i, j, k], feet[2, i, j, k],
                    n_points, limited,
                )  # fmt: skip
                if grows:
                    value *= np.exp(growth[i, j, k])
                out[i, j, k] = value


@njit(cache=True, parallel=True, fastmath={"contract"}, error_model="numpy")
def interpolate_at_perturbed_feet(
    h, feet, growth, displacement, n_points, limited, upper, out
):
    """out = e^growth max (or min) of e^{∓δ·∇B} h at foot ± δ, δ = η b ds².

    h, out (n1, n2, n_alpha); feet and growth as in `interpolate_at_feet`; δ as in
    `Displacement`. `upper` chooses the maximum.
    """
    speed1, speed2, force1, force2, cosine, sine, angular, slope1, slope2 = displacement
    n1, n2, n_alpha = h.shape
    grows = growth.size > 1
    for i in prange(n1):
        for j in range(n2):
            for k in range(n_alpha):
                turn = angular * (force1[i, j] * sine[k] - force2[i, j] * cosine[k])
                tilt = slope1[k] * force1[i, j] + slope2[k] * force2[i, j]
                x, y, z = feet[0, i, j, k], feet[1, i, j, k], feet[2, i, j, k]
                ahead = value_at(
                    h, x + speed1[k], y + speed2[k], z + turn, n_points, limited
                )
                behind = value_at(
                    h, x - speed1[k], y - speed2[k], z - turn, n_points, limited
                )
                lighter = np.exp(-tilt)
                ahead *= lighter
                behind /= lighter
                value = max(ahead, behind) if upper else min(ahead, behind)
                if grows:
                    value *= np.exp(growth[i, j, k])
                out[i, j, k] = value


@njit(cache=True, parallel=True, fastmath={"contract"}, error_model="numpy")
def blend(p, q, theta, out):
    """out = θ p + (1 − θ) q, element by element; all (n1, n2, n_alpha)."""
    n1, n2, n_alpha = p.shape
    for i in prange(n1):
        for j in range(n2):
            for k in range(n_alpha):
                out[i, j, k] = theta * p[i, j, k] + (1.0 - theta) * q[i, j, k]
