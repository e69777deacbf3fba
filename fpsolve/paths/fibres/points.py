"""The points of one or several fibres as one array."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array, check_finite_numbers
from fpsolve._support.checks import shown

__all__ = ["checked_points"]

# Points of a piece: fewer have no curvature that changes.
FEWEST_POINTS = 5


def checked_points(eta: Any, lengths: Any) -> tuple[Array, NDArray[np.int64]]:
    """All points in one array and how many each fibre has."""
    several = isinstance(eta, list | tuple) and bool(eta) and np.ndim(eta[0]) == 2
    pieces = [check_finite_numbers("eta", one) for one in (eta if several else [eta])]
    for piece in pieces:
        if piece.ndim != 2 or piece.shape[1] != 2:
            raise ValueError(
                "`eta` must have the shape (n, 2), a point a row, got shape "
                f"{piece.shape}."
            )
    points = np.concatenate(pieces)
    if lengths is None or several:
        lengths = [len(piece) for piece in pieces]
    counts = np.array(lengths, dtype=np.int64)
    if counts.sum() != len(points) or counts.ndim != 1:
        raise ValueError(
            f"`lengths` must be the numbers of all {len(points)} points, got "
            f"{shown(lengths)}."
        )
    if not counts.min() >= FEWEST_POINTS:
        raise ValueError(
            f"`eta` must have at least {FEWEST_POINTS} points a fibre, got "
            f"{counts.min()}."
        )
    return points, counts
