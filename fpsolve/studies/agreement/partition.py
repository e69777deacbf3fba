"""Coarse cells for a histogram: boxes of fine cells with about equal probability."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array

__all__ = ["ELSEWHERE", "equal_probability_bins", "equal_probability_boxes"]

Labels = NDArray[np.intp]
Box = tuple[slice, ...]

# Label of what belongs to no box: the tails in ξ.
ELSEWHERE = 0
# Share of the mass in the tails. With a million paths it is known to 3 %, and the
# density outside of the box, which the solver folds back, is a part of it.
TAILS = 1e-3


def equal_probability_boxes(probabilities: Array, most: int, least: float) -> Labels:
    """Label of every fine cell: at most `most` boxes by repeated halving, and tails.

    The columns over ξ with the least probability, about 1e-3 together, are
    `ELSEWHERE`. What is left is halved at the median along ξ1, ξ2 and α in turn, as
    long as both halves keep the probability `least`. Where counts are expected to be
    the same everywhere, a chi-square test sees a relative change of the density as
    well in one place as in another.

    Parameters
    ----------
    probabilities : ndarray, shape (n1, n2, n_alpha)
        Probability of every fine cell.
    most : int
        Largest number of boxes; a power of two is reached, another is rounded down.
    least : float
        Smallest probability of a box, and of the tails.

    Returns
    -------
    ndarray of int, shape (n1, n2, n_alpha)
        `ELSEWHERE` or the number of the box, from 1.
    """
    labels: Labels = np.full(probabilities.shape, ELSEWHERE, dtype=np.intp)
    kept = ~_tails(probabilities.sum(axis=2), max(least, TAILS))
    inside = np.where(kept[:, :, None], probabilities, 0.0)
    whole = tuple(slice(0, n) for n in probabilities.shape)
    depth = max(0, most.bit_length() - 1)
    for number, box in enumerate(_halved(inside, whole, depth, 0, least), start=1):
        labels[box] = number
    labels[~kept] = ELSEWHERE
    return labels


def equal_probability_bins(probabilities: Array, most: int, least: float) -> Labels:
    """Label of every cell on a line: neighbours joined to bins, numbered from 0.

    Parameters
    ----------
    probabilities : ndarray, shape (n,)
    most : int
        Largest number of bins.
    least : float
        Smallest probability of a bin.
    """
    total = float(probabilities.sum())
    wanted = max(total / most, least)
    labels: Labels = np.zeros(probabilities.size, dtype=np.intp)
    number, collected, left = 0, 0.0, total
    following = np.append(probabilities[1:], 0.0)
    for place, probability in enumerate(probabilities):
        labels[place] = number
        collected, left = collected + probability, left - probability
        # The bin is full where another cell would take it further from what is wanted.
        full = collected >= least and collected + following[place] / 2 >= wanted
        if full and left >= least and number < most - 1:
            number, collected = number + 1, 0.0
    return labels


def _tails(columns: Array, share: float) -> NDArray[np.bool_]:
    """Columns over ξ of least probability that have the share together."""
    order = np.argsort(columns, axis=None)
    enough = int(np.searchsorted(np.cumsum(columns.ravel()[order]), share))
    tails = np.zeros(columns.size, dtype=bool)
    tails[order[: enough + 1]] = True
    return tails.reshape(columns.shape)


def _halved(
    inside: Array, box: Box, depth: int, axis: int, least: float
) -> Iterator[Box]:
    """Yield the boxes into which `box` falls by halving it `depth` times."""
    turns = [(axis + turn) % len(box) for turn in range(len(box))] if depth else []
    for along in turns:
        place = _median(inside[box], along, least)
        if place is not None:
            first, second = list(box), list(box)
            middle = box[along].start + place
            first[along] = slice(box[along].start, middle)
            second[along] = slice(middle, box[along].stop)
            following = (along + 1) % len(box)
            for half in (first, second):
                yield from _halved(inside, tuple(half), depth - 1, following, least)
            return
    yield box


def _median(block: Array, axis: int, least: float) -> int | None:
    """Cells before the cut nearest to the median; None if a half has too little."""
    others = tuple(other for other in range(block.ndim) if other != axis)
    below = np.cumsum(block.sum(axis=others))
    total = float(below[-1])
    if below.size < 2 or total < 2 * least:
        return None
    cut = int(np.argmin(np.abs(below[:-1] - total / 2)))
    lower = float(below[cut])
    return cut + 1 if min(lower, total - lower) >= least else None
