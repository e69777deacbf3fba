"""How far the functional of a finite fibre is from its expectation."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array
from fpsolve.paths.fibres.fibre_curve import FibreCurve
from fpsolve.studies.identification.increments import (
    Sample,
    Squares,
    log_functional,
    samples_of,
    squares,
)

__all__ = ["bootstrap_covariance", "larger"]

# Blocks that are drawn again, their length in units of k_max at least, and draws.
N_BLOCKS, REACH, N_DRAWS = 40, 5, 400
# Blocks below which a bootstrap says nothing.
FEWEST = 10


def bootstrap_covariance(
    fibre: FibreCurve,
    lags: NDArray[np.int64],
    seed: int,
    numbers: Callable[[Squares], Array] = log_functional,
) -> Array | None:
    """Covariance of log F, or other numbers, by drawing blocks of the fibre again.

    None where there are fewer than ten blocks of five k_max.
    """
    blocks = [_means(piece, lags, fibre.ds) for piece in _blocks(fibre, lags)]
    if len(blocks) < FEWEST:
        return None
    stacked = Squares(*(
        np.concatenate([getattr(one, name) for one in blocks], axis=1)
        for name in ("xi", "angle", "curvature")
    ))  # fmt: skip
    rng = np.random.default_rng(seed)
    chosen = rng.integers(len(blocks), size=(N_DRAWS, len(blocks)))
    drawn = Squares(*(
        part[:, chosen].mean(axis=2)
        for part in (stacked.xi, stacked.angle, stacked.curvature)
    ))  # fmt: skip
    return np.asarray(np.cov(numbers(drawn)))


def larger(covariance: Array, other: Array | None) -> Array:
    """The first, with standard deviations that are at least those of the other."""
    if other is None:
        return covariance
    factors = np.sqrt(np.diag(other) / np.diag(covariance))
    factors = np.maximum(1.0, factors)
    return np.asarray(covariance * np.outer(factors, factors))


def _blocks(fibre: FibreCurve, lags: NDArray[np.int64]) -> list[Sample]:
    size = max(len(fibre.eta) // N_BLOCKS, REACH * int(lags[-1]))
    return [
        Sample(one.xi[k : k + size], one.alpha[k : k + size - 1])
        for one in samples_of(fibre)
        for k in range(0, len(one.xi) - size + 1, size)
    ]


def _means(block: Sample, lags: NDArray[np.int64], ds: float) -> Squares:
    return squares([block], lags, ds)
