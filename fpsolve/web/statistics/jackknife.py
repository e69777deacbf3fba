"""Standard errors of functions of means, by leaving out one block at a time."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.web.statistics.blocks import FEWEST_BLOCKS, choose_blocks
from fpsolve.web.statistics.estimate import Estimate
from fpsolve.web.statistics.influence import influence

__all__ = ["estimate", "jackknife", "variance_and_bias"]


def jackknife(
    function: Callable[[Array], Array], sums: Array, sizes: Array
) -> tuple[Array, Array]:
    """θ̂ = f(Σ_b S_b / Σ_b m_b) and its standard error over independent blocks b.

    With h_b = Σm/m_b and θ̂_(b) without block b, pseudo-values h_b θ̂ - (h_b - 1) θ̂_(b)
    have the mean θ̃, free of the first bias of θ̂, and
    variance = n⁻¹ Σ_b (pseudo-value_b - θ̃)²/(h_b - 1).
    The bias θ̂ - θ̃ is added to it as a square; θ̂ itself stays what its definition says.

    Parameters
    ----------
    function : callable
        f of an array of means along its last axis, free to return several numbers on
        that axis.
    sums : array
        S_b, of shape (n, number of means).
    sizes : array
        m_b > 0.

    Returns
    -------
    tuple of array
        θ̂ and its standard error; the latter NaN for fewer than 4 blocks.

    References
    ----------
    [BMVL99]_.
    """
    value, variance, bias = variance_and_bias(function, sums, sizes)
    return value, np.sqrt(variance + bias**2)


def variance_and_bias(
    function: Callable[[Array], Array], sums: Array, sizes: Array
) -> tuple[Array, Array, Array]:
    """θ̂, the variance of the pseudo-values, and θ̂ - θ̃; arguments as for `jackknife`.

    The bias is that against an endless web. Of what is defined for this one, as the
    variance of a profile with its noise, it is none.
    """
    total, size = sums.sum(axis=0), sizes.sum()
    value = np.asarray(function(total / size))
    n = len(sizes)
    if n < FEWEST_BLOCKS:
        return value, np.full(value.shape, np.nan), np.full(value.shape, np.nan)
    without = np.asarray(function((total - sums) / (size - sizes)[:, None]))
    shares = (size / sizes).reshape(-1, *[1] * value.ndim)
    pseudo = shares * value - (shares - 1.0) * without
    corrected = np.sum(pseudo / shares, axis=0)
    variance = np.mean((pseudo - corrected) ** 2 / (shares - 1.0), axis=0)
    return value, variance, value - corrected


def estimate(
    function: Callable[[Array], Array],
    fields: list[Array],
    cell: float,
    block: float | None,
    shortest: float = 0.0,
) -> Estimate:
    """Return f(means of the fields) as one number with its standard error.

    Parameters
    ----------
    function : callable
        f of an array of means on its last axis.
    fields : list of array
        Cross × machine direction.
    cell : float
        Side of a cell of the fields.
    block : float, optional
        Side of the blocks; by default as the influence of the cells on f remembers.
    shortest : float
        What a block must hold.
    """
    blocks = choose_blocks(influence(function, fields), cell, block, shortest)
    sums = np.stack([blocks.sums(field) for field in fields], axis=-1)
    value, errors = jackknife(function, sums, blocks.sizes)
    error = math.sqrt(blocks.inflation) * float(errors)
    n_samples = math.prod(blocks.cells)
    return Estimate(float(value), error, blocks.n_blocks, n_samples, blocks.reason)
