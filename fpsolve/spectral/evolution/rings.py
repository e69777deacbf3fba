"""Values of an expansion in sectors on rings and on grids, and its relative entropy."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from scipy import fft
from scipy.special import gammaln

from fpsolve._kernels.lanes import LANES
from fpsolve._kernels.sector_values import (
    entropy_integrand,
    sums_at_points,
    sums_on_rings,
)
from fpsolve._support.arrays import Array, Complex
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.spectral.bases.sectors import Integers
from fpsolve.spectral.evolution.sector_expansion import SectorExpansion

__all__ = ["Entropy", "circular_functions", "density_on", "relative_entropy"]

# Values computed at a time, and rings of a grid.
CHUNK, RINGS = 2**21, 256
REFINEMENTS, FINER = 5, 1.5
# First nodes: angles beyond those that resolve the expansion, and radii.
MORE_ANGLES, RADII, PER_WAVE = 1.1, 40.0, 3.0
# The errors of a rule and of those with a half and a quarter of its nodes fall at least
# as a geometric series: what is left of the last change, times SAFETY.
SAFETY, ROUNDING = 4.0, 1e-14
# An error of nothing is taken as this.
LEAST = 1e-300


class Entropy(NamedTuple):
    """H, the error of its quadrature, and what carries errors of h over to it.

    Attributes
    ----------
    value, doubt : float
    norms : ndarray, shape (n_sectors,)
        ‖ln h‖ in L²(μ) of every sector M ≥ 0.
    rest : float
        The same of all beyond, ±M.
    threshold, empty : float
        The root of the error, and μ where h is less.
    """

    value: float
    doubt: float
    norms: Array
    rest: float
    threshold: float
    empty: float

    def error(self, errors: Array, lacking: float) -> float:
        """What H may be wrong by for errors of the sectors, and of all beyond them.

        |φ(h + e) − φ(h) − e ln(h + e)| ≤ e²/(h + e) for φ(h) = h ln h − h, by
        convexity: the first order is a scalar product in every sector, and where h is
        above the threshold, the rest is of second order. Elsewhere, where what is below
        the error counts as the error, it is taken to be |e| at most.
        """
        first = errors[0] * self.norms[0] + 2.0 * float(errors[1:] @ self.norms[1:])
        others = math.sqrt(2.0) * float(np.linalg.norm(errors[1:])) + lacking
        both = math.hypot(errors[0], others)
        second = both * (both / self.threshold + math.sqrt(self.empty))
        return float(first + lacking * self.rest + min(both, second))


class Rule(NamedTuple):
    """Numbers of nodes, multiples of eight."""

    radii: int
    turns: int
    angles: int


def relative_entropy(h: SectorExpansion, tolerance: float, error: float) -> Entropy:
    """H(p|p_S) = ∫ (h ln h − h + 1) dμ on rings: r, the angle φ of ξ, and α − φ.

    Clenshaw-Curtis in r, trapezoids in both angles. Every term is non-negative, so that
    small entropies keep their digits; where h is negative it counts as zero. Nodes are
    added until the error of every rule is below the tolerance, at most `REFINEMENTS`
    times. In ln h, h counts as no less than the `error`.
    """
    width = math.sqrt(4.0 * math.log(1e3 / tolerance))
    rule = Rule(
        _eights(RADII + PER_WAVE * math.sqrt(h.degree)),
        _eights(MORE_ANGLES * (2 * len(h.values) + 1)),
        _eights(MORE_ANGLES * (2 * h.harmonics + 1)),
    )
    for refinement in range(REFINEMENTS + 1):
        value, doubts, others = _entropy_sums(h, rule, width, error)
        if refinement == REFINEMENTS or max(doubts) <= tolerance:
            break
        rule = Rule(*(
            _eights(FINER * n) if doubt > tolerance else n
            for n, doubt in zip(rule, doubts, strict=True)
        ))  # fmt: skip
    return Entropy(value, sum(doubts) + ROUNDING * abs(value), *others)


def _eights(n: float) -> int:
    return 8 * math.ceil(n / 8)


def _entropy_sums(
    h: SectorExpansion, rule: Rule, width: float, error: float
) -> tuple[float, tuple[float, float, float], tuple[Array, float, float, float]]:
    """The entropy, errors in r, φ and α − φ, and the rest of an `Entropy`."""
    points, weights = clenshaw_curtis(rule.radii)
    r = 0.5 * width * (points + 1.0)
    measure = 0.5 * width * r * np.exp(-0.5 * r**2)
    error, n_sectors = max(error, LEAST), len(h.values)
    rows = np.concatenate(
        [
            _ring_means(values, error, n_sectors)
            for values in ring_values(h, r, rule, less=1.0)
        ]
    )
    means = rows[: r.size].T * measure
    full, fewer_turns, fewest_turns, fewer_angles, fewest_angles = means[:5] @ weights
    half, quarter = (
        float(means[0, ::step] @ clenshaw_curtis(rule.radii // step)[1])
        for step in (2, 4)
    )
    doubts = (
        _left(full, half, quarter),
        _left(full, fewer_turns, fewest_turns),
        _left(full, fewer_angles, fewest_angles),
    )
    empty, both, *squares = np.maximum(means[5:] @ weights, 0.0)
    rest = max(both - squares[0] - 2.0 * sum(squares[1:]), 0.0)
    others = np.sqrt(squares), math.sqrt(rest), math.sqrt(error), float(empty)
    return float(full), doubts, others


def _left(full: float, half: float, quarter: float) -> float:
    """Error of a rule, from those with a half and a quarter of its nodes."""
    change, before = abs(full - half), abs(half - quarter)
    return float(change * min(1.0, SAFETY * change / max(before, 1e-300)))


def _ring_means(excess: Array, error: float, n_sectors: int) -> Array:
    """Of every ring the entropy by all nodes and by fewer, and of ln h squares.

    All nodes, every second and fourth φ, every second and fourth α − φ; then the share
    where h is less than the root of the error, the mean of (ln h)², and that of its
    parts in all sectors M ≥ 0.
    """
    flat = excess.reshape(-1)
    out = np.empty_like(flat)
    entropy_integrand(flat, error, out)
    integrand, logarithm = out.reshape(excess.shape), flat.reshape(excess.shape)
    parts = (
        integrand, integrand[:, ::2], integrand[:, ::4],
        integrand[:, :, ::2], integrand[:, :, ::4],
    )  # fmt: skip
    means = [part.mean(axis=(1, 2)) for part in parts]
    square: Any = np.einsum("rpq,rpq->r", logarithm, logarithm) / logarithm[0].size
    empty = np.mean(logarithm <= 0.5 * math.log(error), axis=(1, 2))
    waves = fft.rfft(logarithm, axis=1, norm="forward")[:, :n_sectors]
    parts_of_square = np.mean(waves.real**2 + waves.imag**2, axis=2)
    return np.column_stack([*means, empty, square, parts_of_square])


def ring_values(
    h: SectorExpansion, r: Array, rule: Rule, less: float = 0.0
) -> Iterator[Array]:
    """p/p_S − less at r × φ × (α − φ), some rings at a time, then rings repeated."""
    at_once = max(1, CHUNK // (LANES * rule.turns * rule.angles)) * LANES
    padded = np.concatenate([r, np.repeat(r[-1:], -r.size % LANES)])
    k = np.arange(-h.harmonics, h.harmonics + 1)
    for start in range(0, padded.size, at_once):
        here = padded[start : start + at_once]
        waves = np.zeros((here.size, len(h.values), rule.angles), complex)
        waves[:, :, k] = sector_waves(h, here)
        waves[:, 0, 0] -= less * np.exp(-0.25 * here**2)
        waves = fft.ifft(waves, axis=2, norm="forward", overwrite_x=True)
        values = fft.irfft(waves, rule.turns, axis=1, norm="forward")
        values *= np.exp(0.25 * here**2)[:, None, None]
        yield values


def sector_waves(h: SectorExpansion, r: Array) -> Complex:
    """√weight g_Mk(r), h = Σ g_Mk e^{iMφ + ik(α − φ)}; shape (r, M, 2K + 1)."""
    harmonics = h.harmonics
    angular = harmonics + len(h.values) - 1
    longest = max(int(counts.max()) for counts in h.counts)
    functions = circular_functions(angular, longest, r)
    waves = np.zeros((r.size, len(h.values), 2 * harmonics + 1), complex)
    for index, (values, counts) in enumerate(zip(h.values, h.counts, strict=True)):
        sums = np.zeros((2, counts.size, r.size))
        sums_on_rings(values, counts, index, functions, sums)
        own = (counts.size - 3) // 2
        reach = min(own, harmonics)
        found = sums[:, own + 1 - reach : own + 2 + reach]
        place = slice(harmonics - reach, harmonics + reach + 1)
        waves[:, index, place] = (found[0] + 1j * found[1]).T
    return waves


def circular_functions(angular: int, n: int, r: Array) -> Array:
    """e^{−x/2} ψ_lm(x), x = r²/2, for l ≤ angular and m < n; shape (l, m, r).

    ψ_lm = (−1)^m √(m!/(m + l)!) x^{l/2} L_m^{(l)}(x) by the recurrence in m, stable for
    growing m.
    """
    x, power = 0.5 * r**2, np.arange(angular + 1.0)[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        logarithm = np.where(power > 0, 0.5 * power * np.log(x), 0.0)
    result = np.empty((angular + 1, n, r.size))
    result[:, 0] = np.exp(logarithm - 0.5 * gammaln(power + 1) - 0.5 * x)
    for m in range(1, n):
        step = (x - (2 * m - 1 + power)) * result[:, m - 1]
        if m > 1:
            step -= np.sqrt((m - 1) * (m - 1 + power)) * result[:, m - 2]
        result[:, m] = step / np.sqrt(m * (m + power))
    return result


@lru_cache(maxsize=32)
def clenshaw_curtis(n: int) -> tuple[Array, Array]:
    """Nodes cos(πj/n), j = 0 … n, n even, and weights on [−1, 1]."""
    angles = math.pi * np.arange(n + 1) / n
    weights: Array
    k = np.arange(1, n // 2)[:, None]
    inner = 1.0 - 2.0 * np.sum(np.cos(2 * k * angles) / (4 * k**2 - 1), axis=0)
    weights = 2.0 / n * (inner - np.cos(n * angles) / (n**2 - 1))
    weights[[0, -1]] = 1.0 / (n**2 - 1)
    return np.cos(angles), weights


def density_on(h: SectorExpansion, grid: PhaseSpaceGrid, sigma: float) -> Array:
    """p at the cell centres of a grid; shape ``grid.shape``.

    Rings through all centres, then the powers of e^{iφ}, then a Fourier series in α.
    """
    x1, x2 = np.broadcast_arrays(*(axis / sigma for axis in grid.plane()))
    # Centres on one ring differ in rounding.
    squares, ring = np.unique(np.round(x1**2 + x2**2, 12), return_inverse=True)
    ring = np.asarray(ring.reshape(-1), np.int64)
    turn = np.exp(1j * np.arctan2(x2, x1)).reshape(-1)
    n_alpha, k = grid.shape[2], np.arange(h.harmonics + 1)
    # A multiple of the angles asked for that resolves the highest harmonic.
    finer = math.ceil((2 * h.harmonics + 1) / n_alpha)
    p = np.empty((ring.size, n_alpha))
    for start in range(0, squares.size, RINGS):
        here = np.flatnonzero((ring >= start) & (ring < start + RINGS))
        r = np.sqrt(squares[start : start + RINGS])
        r = np.concatenate([r, np.repeat(r[-1:], -r.size % LANES)])
        waves = _waves_at(h, r, ring[here] - start, turn[here])
        waves *= np.exp(1j * k * grid.alpha[0])
        values = fft.irfft(waves, n_alpha * finer, axis=1, norm="forward")
        weight = np.exp(-0.25 * r[ring[here] - start] ** 2)
        p[here] = values[:, ::finer] * weight[:, None]
    return np.asarray(p.reshape(grid.shape) / (2 * math.pi * sigma) ** 2)


def _waves_at(h: SectorExpansion, r: Array, ring: Integers, turn: Complex) -> Complex:
    """√weight ĥ_k at points of rings, k ≥ 0; shape (points, k).

    From M ≥ 0 and, as h is real, g_{−M,k} = conj g_{M,−k}.
    """
    waves = sector_waves(h, r)
    last = h.harmonics
    positive = np.ascontiguousarray(waves[:, :, last:])
    negative = np.ascontiguousarray(waves[:, :, last::-1].conj())
    negative[:, 0] = 0.0
    found, others = (np.empty((ring.size, last + 1), complex) for _ in range(2))
    sums_at_points(positive, ring, turn, found)
    sums_at_points(negative, ring, turn.conj(), others)
    return np.asarray((found + others) * turn.conj()[:, None] ** np.arange(last + 1))
