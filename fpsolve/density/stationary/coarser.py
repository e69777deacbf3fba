"""Coarser grids of the same box, and densities carried from one to another."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array

__all__ = ["carried", "coarser_grid"]

# What a scheme needs, and what leaves a coarser grid below it.
FEWEST, LEAST = 4, 6
OF_CURVATURE = 3 / 4


def coarser_grid(grid: Any, share: float) -> Any:
    """The same box with at most this share of the cells in every direction.

    Of those of a curvature three quarters are left, which have to resolve it. Along ξ
    the number stays even or odd as it was: where ∇B jumps at the origin, it matters
    whether a centre of a cell lies there. So it does along α, where some schemes need
    an even number.

    Raises
    ------
    ValueError
        If there are too few cells to do with fewer.
    """
    shape = tuple(fewer(n, share) for n in grid.shape[:3])
    shape += tuple(fewer(n, max(share, OF_CURVATURE)) for n in grid.shape[3:])
    if not all(m < n for m, n in zip(shape, grid.shape, strict=True)):
        raise ValueError(
            f"`grid` must have at least {LEAST} cells in every direction, so that a "
            f"coarser one can tell its error, got {grid.shape}."
        )
    return replace(grid, shape=shape)


def fewer(n: int, share: float) -> int:
    """The largest number up to share · n of the same parity; at least `FEWEST`."""
    remainder = n % 2
    return max(FEWEST + remainder, 2 * int((share * n - remainder) / 2) + remainder)


def carried(p: Array, shape: tuple[int, ...]) -> Array:
    """p by its trigonometric interpolant at the centres of `shape` cells."""
    for axis, n in enumerate(shape):
        if n != p.shape[axis]:
            moved = np.tensordot(interpolation_matrix(p.shape[axis], n), p, (1, axis))
            p = np.moveaxis(moved, 0, axis)
    return np.ascontiguousarray(p)


def interpolation_matrix(n: int, m: int) -> Array:
    """Values at the centres of m cells of the interpolant of n centre values."""
    old = (np.arange(n) + 0.5) * (2 * math.pi / n)
    new = (np.arange(m) + 0.5) * (2 * math.pi / m)
    apart = new[:, None] - old
    harmonics = np.arange(1, (n - 1) // 2 + 1)
    total = 1.0 + 2.0 * np.cos(apart[..., None] * harmonics).sum(axis=-1)
    if n % 2 == 0:
        total = total + np.cos(apart * (n // 2))
    return np.asarray(total / n)
