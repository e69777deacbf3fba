"""Matrices of the angle step, one per value of |∇B| or interpolated between nodes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fpsolve._kernels.lanes import LANES
from fpsolve._kernels.moebius import first_of_group, rotation_matrices
from fpsolve._kernels.rotation import QUADS_PER_BATCH, RotationTable
from fpsolve._support.arrays import Array

# Values of |∇B| that are closer than this, relative to the smallest of them, share a
# matrix: they differ by rounding only (mirror images of a cell). So do those that turn
# the angle by less than rounding in a step.
SAME_STRENGTH = 1e-13
SAME_TURN = 1e-18
# A table may hold this many densities; above, matrices are interpolated.
LARGEST_TABLE = 3.0
# Chebyshev nodes per interval of ψ = arccos tanh(|∇B| ds/4), in which the entries
# are trigonometric polynomials of degree below n_alpha; see `interval_width`.
NODES = 8


def rotation_table(
    strength: Array, diffusivity: float, ds: float, n_alpha: int, balanced: bool
) -> RotationTable:
    """Table of R½ D R½ for all rows; interpolated if exact matrices need too much.

    Parameters
    ----------
    strength : ndarray, shape (n1 n2,)
        |∇B| at the cells.
    diffusivity : float
        A²/2.
    ds : float
    n_alpha : int
    balanced : bool
        Matrices for h = p/p_S (constants kept) instead of p (mass kept).
    """
    rows = np.argsort(strength, kind="stable")
    ordered = strength[rows]
    half = n_alpha // 2
    heat = np.exp(-diffusivity * ds * np.arange(half) ** 2)
    damping = float(np.exp(-diffusivity * ds * half**2))
    new = np.empty(ordered.size, dtype=np.bool_)
    first_of_group(ordered, SAME_STRENGTH, SAME_TURN / max(abs(ds), SAME_TURN), new)
    if np.count_nonzero(new) * half**2 <= LARGEST_TABLE * strength.size * n_alpha:
        matrix_of = np.cumsum(new) - 1
        angles = opening(ordered[new], ds)
        coefficients = np.ones((rows.size, 1))
        matrices = matrices_at(angles, heat, balanced)[None]
    else:
        angles = opening(ordered, ds)
        matrix_of, coefficients, nodes = chebyshev_intervals(angles, half)
        matrices = np.stack([matrices_at(at, heat, balanced) for at in nodes])
    places, quad_matrix = quads(matrix_of)
    by_quad = coefficients[places].reshape(-1, LANES, coefficients.shape[1])
    return RotationTable(
        rows[places],
        quad_matrix,
        np.ascontiguousarray(by_quad.transpose(0, 2, 1)),
        matrices,
        damping,
    )


def quads(matrix_of: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Places in the sorted rows, four of one matrix at a time, and those matrices.

    Where the rows of a matrix are no multiple of four the last is repeated, and so is
    the last quad until the last batch is full: the same result is written twice.
    """
    starts = np.flatnonzero(np.diff(matrix_of, prepend=-1))
    sizes = np.diff(starts, append=matrix_of.size)
    n_quads = -(-sizes // LANES)
    first = np.repeat(np.cumsum(n_quads) - n_quads, n_quads)
    within = np.arange(n_quads.sum()) - first
    offsets = LANES * within[:, None] + np.arange(LANES)
    last = np.repeat(sizes, n_quads)[:, None] - 1
    places = np.repeat(starts, n_quads)[:, None] + np.minimum(offsets, last)
    places = np.pad(places, ((0, -len(places) % QUADS_PER_BATCH), (0, 0)), mode="edge")
    return places.ravel(), matrix_of[places[:, 0]]


def opening(strength: Array, ds: float) -> Array:
    """ψ = arccos tanh(|∇B| ds/4): π/2 for no force, 0 for an infinite one."""
    angle: Array = np.arccos(np.tanh(strength * (ds / 4)))
    return angle


def matrices_at(angles: Array, heat: Array, balanced: bool) -> Array:
    """R½ D R½ at the given ψ; shape (angles.size, M, M), mode in, mode out."""
    matrices = np.empty((angles.size, heat.size, heat.size))
    rotation_matrices(np.cos(angles), heat, balanced, matrices)
    return matrices


def interval_width(half: int) -> float:
    """Width in ψ of one interpolation interval.

    Entries between mode m and n have degree m + n < 2M in ψ, so eight Chebyshev
    nodes on a width 1/(2M) leave about (2M · width/4)⁸ · 2/8! ≈ 8e-10 at the
    highest modes and less than 1e-14 below a quarter of them.
    """
    return 1.0 / (2 * half)


def chebyshev_intervals(
    angles: Array, half: int
) -> tuple[NDArray[np.int64], Array, Array]:
    """Interval of every ψ, its interpolation weights, and the nodes (Q, n_intervals).

    Only intervals that contain a row are kept. The weights sum to one, so mass and
    constants are kept as by the exact matrices.
    """
    width = interval_width(half)
    cells, matrix_of = np.unique(
        np.floor((np.pi / 2 - angles) / width).astype(np.int64), return_inverse=True
    )
    centres = np.pi / 2 - (cells + 0.5) * width
    unit = np.cos((np.arange(NODES) + 0.5) * np.pi / NODES)
    nodes = centres + 0.5 * width * unit[:, None]
    place = (angles - centres[matrix_of]) / (0.5 * width)
    return matrix_of, barycentric(place, unit), nodes


def barycentric(place: Array, unit: Array) -> Array:
    """Lagrange weights of the points `place` for the Chebyshev nodes `unit`."""
    weights = np.empty((place.size, unit.size))
    for q, node in enumerate(unit):
        others = np.delete(unit, q)
        weights[:, q] = np.prod((place[:, None] - others) / (node - others), axis=1)
    total: Array = weights / weights.sum(axis=1, keepdims=True)
    return total
