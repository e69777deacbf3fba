"""Tests of counts and of means, each with the smallest disagreement that it sees.

Every test has a size: the probability that it rejects what is right. `POWER` is the
probability with which it rejects what differs by the `detectable` amount. What is right
may itself be known with an error only: no test rejects what differs by that error with
more than its size.
"""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import optimize, stats

from fpsolve._support.arrays import Array

__all__ = ["POWER", "Outcome", "chi_square", "largest_deviation", "scores", "z_score"]

Counts = NDArray[np.int64]

POWER = 0.99
# Below this a difference of two numbers that have no standard error is rounding.
ROUNDING = 1e-12


class Outcome(NamedTuple):
    """What a test found.

    Attributes
    ----------
    statistic : float
    p_value : float
        Probability of a statistic at least as extreme when both sides are right.
    critical : float
        Value from which on the statistic means disagreement.
    detectable : float
        Smallest disagreement that is detected with the probability `POWER`.
    degrees : int or None
        Degrees of freedom, or the number of cells of `largest_deviation`.
    """

    statistic: float
    p_value: float
    critical: float
    detectable: float
    degrees: int | None = None


def chi_square(
    counts: Counts, probabilities: Array, size: float, error: Array | None = None
) -> Outcome:
    """Pearson's Σ (n_i − N q_i)²/(N q_i) against χ² with k − 1 degrees of freedom.

    With errors e_i of the probabilities it is a noncentral χ², with the noncentrality
    N Σ e_i²/q_i.

    Detectable is an L1 distance: every density with Σ|q′_i − q_i| ≥ √(λ/N) is
    rejected with probability `POWER`, because Σ (q′ − q)²/q ≥ (Σ|q′ − q|)² makes the
    noncentrality at least λ. Smooth differences are seen from less. The law of the
    statistic is asymptotic; with at least 25 expected counts in every cell its error
    is far below that of any other number here.

    Parameters
    ----------
    counts : ndarray of int, shape (k,)
    probabilities : ndarray, shape (k,)
        Of the cells, with total 1.
    size : float
        Probability of rejecting what is right.
    error : ndarray, shape (k,), optional
        How far the probabilities may be off.
    """
    n_paths, degrees = int(counts.sum()), counts.size - 1
    if degrees < 1:
        return Outcome(0.0, 1.0, math.inf, math.inf, 0)
    expected = n_paths * probabilities
    statistic = float(((counts - expected) ** 2 / expected).sum())
    law = stats.chi2(degrees)
    if error is not None and np.any(error):
        law = stats.ncx2(degrees, n_paths * float((error**2 / probabilities).sum()))
    critical = float(law.isf(size))
    distance = math.sqrt(_noncentrality(critical, degrees) / n_paths)
    return Outcome(statistic, float(law.sf(statistic)), critical, distance, degrees)


def largest_deviation(
    counts: Counts, probabilities: Array, size: float, error: Array | None = None
) -> Outcome:
    """max |n_i − N q_i|/√(N q_i (1 − q_i)), its p-value from exact binomial tails.

    The p-value is that of the most extreme cell times the number of cells
    (Bonferroni), which bounds the false alarms however the counts depend on each
    other. Detectable is the change of the median cell's probability relative to it.

    Parameters
    ----------
    counts, probabilities, size, error
        As for `chi_square`.
    """
    n_paths, n_cells = int(counts.sum()), counts.size
    off = np.zeros(n_cells) if error is None else np.abs(error)
    below = stats.binom.cdf(counts, n_paths, np.maximum(probabilities - off, 0.0))
    above = stats.binom.sf(counts - 1, n_paths, np.minimum(probabilities + off, 1.0))
    smallest = float(np.minimum(2 * np.minimum(below, above), 1.0).min())
    spread = np.sqrt(n_paths * probabilities * (1 - probabilities))
    critical = float(stats.norm.isf(size / (2 * n_cells)))
    middle = float(np.median(probabilities))
    seen = (critical + _margin()) * math.sqrt((1 - middle) / (n_paths * middle))
    seen += float(np.median(off)) / middle
    critical += float(np.max(n_paths * off / spread))
    statistic = float(np.abs(scores(counts, probabilities)).max())
    return Outcome(statistic, min(1.0, n_cells * smallest), critical, seen, n_cells)


def scores(counts: Counts, probabilities: Array) -> Array:
    """(n_i − N q_i)/√(N q_i (1 − q_i)): deviations of counts in standard deviations."""
    n_paths = int(counts.sum())
    spread = np.sqrt(n_paths * probabilities * (1 - probabilities))
    return np.asarray((counts - n_paths * probabilities) / spread)


def z_score(
    value: float, expected: float, error: float, size: float, off: float = 0.0
) -> Outcome:
    """(value − expected)/error, with its two-sided p-value under the normal law.

    That of the nearest value within `off` of the expected one.

    Detectable is a shift of the expected value.

    Parameters
    ----------
    value, expected, error : float
        The value has the standard error `error`; the expected one has none.
    size : float
        Probability of rejecting what is right.
    off : float
        How far the expected value may be off.
    """
    difference = value - expected
    critical = float(stats.norm.isf(size / 2))
    seen = (critical + _margin()) * error + off
    if error > 0:
        statistic, allowed = difference / error, off / error
    else:
        rounding = ROUNDING * max(1.0, abs(expected))
        statistic = 0.0 if abs(difference) <= rounding + off else math.inf
        allowed = 0.0
    p_value = float(2 * stats.norm.sf(max(abs(statistic) - allowed, 0.0)))
    return Outcome(statistic, p_value, critical + allowed, seen)


def _margin() -> float:
    """Standard deviations beyond the critical value at which `POWER` is reached."""
    return float(stats.norm.ppf(POWER))


@cache
def _noncentrality(critical: float, degrees: int) -> float:
    """λ of the noncentral χ² that exceeds the critical value with `POWER`."""

    def lacking(amount: float) -> float:
        return POWER - float(stats.ncx2.sf(critical, degrees, amount))

    return float(optimize.brentq(lacking, 1e-9, 4 * critical + 100.0))
