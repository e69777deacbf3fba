"""A density that an entropy is relative to."""

from __future__ import annotations

import numpy as np

from fpsolve._support.arrays import Array, check_finite_numbers, check_numbers
from fpsolve.errors import GridMismatchError
from fpsolve.grids.phase_space import check_grid
from fpsolve.grids.smooth import AnyGrid, SmoothPhaseSpaceGrid

__all__ = ["as_field", "checked_reference", "reference_sum"]

# Share of the mass of a reference that may lie below zero.
LARGEST_NEGATIVE = 1e-3


def checked_reference(reference: Array, grid: AnyGrid) -> Array:
    """A reference that is finite, has mass and is not negative, as (n1, n2, …).

    A density on a grid may fall below zero in its tails. Up to `LARGEST_NEGATIVE` of
    the mass that counts as zero; the entropy is relative to what is left, scaled to the
    mass of p, which moves it by the logarithm of one more than that share at most.
    """
    reference = check_finite_numbers("reference", reference)
    as_field(reference, grid)
    total = float(reference.sum())
    negative = -float(np.minimum(reference, 0.0).sum())
    if not (total > 0 and negative <= LARGEST_NEGATIVE * total):
        raise ValueError(
            "`reference` must be non-negative with positive mass, got values from "
            f"{reference.min():g} to {reference.max():g}; the entropy is relative to "
            f"a density. Below zero may be {LARGEST_NEGATIVE:g} of the mass; with "
            "more take finer cells, or np.maximum(reference, 0.0)."
        )
    return np.maximum(reference, 0.0) if negative else reference


def as_field(reference: Array, grid: AnyGrid) -> Array:
    """A reference as (n1, n2, 1) or (n1, n2, n_alpha); with a curvature in full."""
    if isinstance(grid, SmoothPhaseSpaceGrid):
        return grid.check(reference, "reference")
    check_grid(grid)
    reference = check_numbers("reference", reference)
    if reference.shape == grid.shape[:2]:
        return reference[:, :, None]
    if reference.shape not in (grid.shape, (*grid.shape[:2], 1)):
        raise GridMismatchError(grid.shape, reference.shape, "reference")
    return reference


def reference_sum(reference: Array, grid: AnyGrid) -> float:
    """Sum of a reference over all cells of the grid."""
    repeats = grid.shape[2] // reference.shape[2]
    return float(reference.sum()) * float(repeats)
