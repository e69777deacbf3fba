"""Entropy and dissipation of a reversible Markov generator on cells."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array

__all__ = ["Exchange", "relative_entropy_of"]


# Masses below this carry nothing; they only have to have a logarithm.
SMALLEST = 1e-300
# A ratio of two sums this close to one is one: the term M ln(M/S) would be noise.
_ROUNDING = 4e-15


def relative_entropy_of(mass: Array, equilibrium: Array) -> float:
    """H = Σ m ln(m/π), without the cancellation of its terms.

    Written as Σ r [(1 + x) ln(1 + x) − x] + M ln(M/S), r = π M/S, x = (m − r)/r, in
    which every term is non-negative and accurate relative to itself: an entropy of
    1e-20 still has correct digits. Masses below 1e-300 count as 1e-300.

    Parameters
    ----------
    mass : ndarray, shape (n,)
        Cell masses m, of total M.
    equilibrium : ndarray, shape (n,)
        Cell masses π of the stationary law, of total S.
    """
    ratio = float(mass.sum() / equilibrium.sum())
    if abs(ratio - 1.0) < _ROUNDING:
        ratio = 1.0
    if not ratio > 0:
        # No entropy without mass.
        return math.nan
    reference = equilibrium * ratio
    excess = mass - reference
    near = np.abs(excess) < 0.5 * reference
    held, expected = np.maximum(mass[~near], SMALLEST), reference[~near]
    logarithm = np.log(held) - np.log(np.maximum(expected, SMALLEST))
    far = float(np.sum(held * logarithm - excess[~near]))
    close = float(reference[near] @ _convex(excess[near] / reference[near]))
    return close + far + float(mass.sum()) * math.log(ratio)


def _convex(x: Array) -> Array:
    """(1 + x) ln(1 + x) − x, by its series where it would cancel."""
    direct: Array = (1.0 + x) * np.log1p(x) - x
    series = x**2 * (0.5 - x / 6.0 + x**2 / 12.0)
    return np.where(np.abs(x) < 1e-4, series, direct)


class Exchange:
    """Σ (a − b)(ln a − ln b) over pairs of cells, a and b the flows both ways.

    This is −⟨Q m, ln(m/π)⟩ = −dH/ds, exactly, for a generator Q in detailed balance
    with π: the flows from i to j and back are a = Q_ji m_i and b = Q_ij m_j, and
    ln(a/b) = ln(m_i/π_i) − ln(m_j/π_j). No term is negative and π is not needed,
    which underflows where the potential is high. Flows below 1e-300 count as 1e-300.

    Parameters
    ----------
    generator : sparse array, shape (n, n)
    """

    def __init__(self, generator: Any) -> None:
        from scipy.sparse import tril

        below = tril(generator, -1).tocoo()
        self.to, self.origin = below.row, below.col
        self.forth = below.data
        # A transposed copy has the reverse rates in the same places.
        self.back = tril(generator.T, -1).tocsr()[self.to, self.origin]
        self.back = np.asarray(self.back).ravel()

    def __call__(self, mass: Array) -> float:
        """−dH/ds at the cell masses m."""
        flow = np.maximum(self.forth * mass[self.origin], SMALLEST)
        reverse = np.maximum(self.back * mass[self.to], SMALLEST)
        net = flow - reverse
        # ln(a/b) from the difference, which is exact where a and b are close.
        near = np.abs(net) < 0.5 * reverse
        ratio = np.log(flow) - np.log(reverse)
        ratio[near] = np.log1p(net[near] / reverse[near])
        return float(net @ ratio)
