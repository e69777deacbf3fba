"""Rows of equal |∇B| side by side: a few large matrix products for the angle step."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fpsolve._kernels.lanes import LANES
from fpsolve._kernels.rotation import RotationTable
from fpsolve._support.arrays import Array

__all__ = ["Blocks", "in_blocks"]

Places = NDArray[np.int64]


class Blocks(NamedTuple):
    """Rows in blocks of one size, each of one matrix.

    Attributes
    ----------
    rows : ndarray of int, shape (n_blocks size,)
        Row numbers; where a block is not full its first row is repeated.
    place_of : ndarray of int, shape (n_rows,)
        Where each row stands in `rows`.
    coefficients : ndarray, shape (n_blocks, size, 1, Q, 1)
        Interpolation weights of the rows; Q = 1 for exact matrices.
    matrices : ndarray, shape (n_blocks, Q M, M)
        Those that are to be combined, one below the other; mode in, mode out.
    """

    rows: Places
    place_of: Places
    coefficients: Array
    matrices: Array


def in_blocks(table: RotationTable, size: int | None = None) -> Blocks:
    """The rows of a table in blocks, of the size that moves the fewest bytes."""
    rows, first = np.unique(table.rows, return_index=True)
    matrix_of = table.matrix_of[first // LANES]
    coefficients = table.coefficients[first // LANES, :, first % LANES]
    n_nodes, n_matrices, n_modes, _ = table.matrices.shape
    counts = np.bincount(matrix_of, minlength=n_matrices)
    size = size or best_size(counts, n_nodes, n_modes)
    n_blocks = -(-counts // size)
    before = np.cumsum(n_blocks) - n_blocks
    order = np.argsort(matrix_of, kind="stable")
    start = np.cumsum(counts) - counts
    within = np.arange(rows.size) - start[matrix_of[order]]
    places = before[matrix_of[order]] * size + within
    filled = np.repeat(order[start[counts > 0]], n_blocks[counts > 0] * size)
    filled[places] = order
    place_of = np.empty_like(rows)
    place_of[order] = places
    which = np.repeat(np.arange(n_matrices), n_blocks)
    stacked = table.matrices[:, which].transpose(1, 0, 2, 3)
    total = which.size
    return Blocks(
        filled,
        place_of,
        coefficients[filled].reshape(total, size, 1, n_nodes, 1),
        stacked.reshape(total, n_nodes * n_modes, n_modes),
    )


def best_size(counts: Places, n_nodes: int, n_modes: int) -> int:
    """The power of two for which matrices and rows of all blocks are the fewest."""
    sizes = [2**k for k in range(int(counts.max() - 1).bit_length() + 1)]
    moved = [
        int((-(-counts // size)).sum())
        * n_modes
        * (n_nodes * n_modes + 2 * size * (1 + n_nodes))
        for size in sizes
    ]
    best: int = sizes[int(np.argmin(moved))]
    return best
