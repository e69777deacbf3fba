"""Ŝ(k) of one smooth fibre at many wave vectors, to a tolerance."""

from __future__ import annotations

import math

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.errors import ToleranceError
from fpsolve.spectral.resolvent.smooth_basis import SmoothBasis
from fpsolve.spectral.resolvent.smooth_generator import SmoothGenerator
from fpsolve.spectral.resolvent.smooth_ladder import SmoothLadder
from fpsolve.spectral.resolvent.smooth_limit import smooth_short_wave_limit
from fpsolve.spectral.resolvent.smooth_solutions import (
    along_long_waves,
    along_short_waves,
)

__all__ = ["smooth_spectrum"]

# |k| in deviations of ξ up to which one factorisation per k1 serves every k2.
LONG = 2.2
# |k| beyond which the fibre is made of arcs: in units of 1/σ, of the curvature, and of
# the wave over which the noise of the curvature turns it.
FAR, FAR_OF_CURVATURE, FAR_OF_NOISE = 24.0, 12.0, 9.0
# States of the largest truncations: of long waves factors are kept, of short ones none.
MOST_LONG, MOST_SHORT = 26_000, 60_000
# Of the smallest truncation for short waves the harmonics by the root of |k|/κ, in
# steps, and the least degree in ξ.
PER_ROOT, STEP, FEWEST = 3.0, 3, 4
# Of the tolerance the part of the stationary law.
SHARE = 0.4


def smooth_spectrum(
    ladder: SmoothLadder, k1: Array, k2: Array, tolerance: float
) -> tuple[Array, Array]:
    """Ŝ at (k1[i], k2[i]) and bounds of the errors.

    Ŝ is even in k1 and in k2: computed once for what differs. The error is at most
    `tolerance` times the larger of Ŝ and σ/(1 + |k| σ), σ the smaller throwing range.
    """
    points = np.stack([np.abs(k1), np.abs(k2)], axis=1)
    distinct, inverse = np.unique(points, axis=0, return_inverse=True)
    values, errors = np.zeros(len(distinct)), np.zeros(len(distinct))
    long = np.hypot(*(distinct * ladder.spreads).T) <= LONG
    level = 0
    for one in np.unique(distinct[long, 0]):
        found = np.flatnonzero(long & (distinct[:, 0] == one))
        values[found], errors[found], level = long_waves(
            ladder, float(one), distinct[found, 1], tolerance, max(level - 2, 0)
        )
    level, others = 0, np.flatnonzero(~long)
    # From long to short, since what was fine enough for one is for the next.
    for place in others[np.argsort(np.hypot(*distinct[others].T), kind="stable")]:
        wave = float(distinct[place, 0]), float(distinct[place, 1])
        values[place], errors[place], level = short_wave(
            ladder, wave, tolerance, max(level - 2, 0)
        )
    inverse = inverse.reshape(-1)
    return values[inverse], errors[inverse]


def allowed(ladder: SmoothLadder, found: Array, k: Array, tolerance: float) -> Array:
    """The largest errors of what was found."""
    sigma = min(ladder.scales)
    return np.asarray(tolerance * np.maximum(np.abs(found), sigma / (1.0 + k * sigma)))


def long_waves(
    ladder: SmoothLadder, k1: float, k2: Array, tolerance: float, level: int = 0
) -> tuple[Array, Array, int]:
    """Ŝ at one k1 and many k2, all of one truncation."""
    return ladder.climb(
        ladder.first,
        lambda generator: along_long_waves(generator, k1, k2.tolist()),
        lambda found: allowed(ladder, found, np.hypot(k1, k2), tolerance),
        level,
        MOST_LONG,
    )


def short_wave(
    ladder: SmoothLadder, k: tuple[float, float], tolerance: float, level: int = 0
) -> tuple[float, float, int]:
    """Ŝ at one k; far away by the law of the angle and what it lacks nearer."""
    ratio = max(1.0, math.hypot(*k) / far_of(ladder))
    nearer = k[0] / ratio, k[1] / ratio
    size = math.hypot(*nearer)
    fine, coarse = ladder.laws(SHARE * tolerance)

    def compute(generator: SmoothGenerator) -> Array:
        basis = generator.basis
        both = [basis.picked(law.basis.table(law.stationary)) for law in (fine, coarse)]
        return along_short_waves(generator, both, nearer)

    values, errors, level = ladder.climb(
        first_of(ladder, size), compute,
        lambda found: allowed(ladder, found, np.asarray(size), (1 - SHARE) * tolerance),
        level, MOST_SHORT,
    )  # fmt: skip
    value, error = float(values[0]), float(errors[0] + 2 * abs(values[0] - values[1]))
    if ratio > 1:
        ends = [smooth_short_wave_limit(law, nearer) for law in (fine, coarse)]
        far_ends = [smooth_short_wave_limit(law, k) for law in (fine, coarse)]
        # Ŝ |k| = that of the limit + correction/|k|⁴ + …
        correction = (value - ends[0]) / ratio**5
        value = far_ends[0] + correction
        error = 2 * abs(correction) + error / ratio**5
    # What two truncations of the law may differ by, whatever they do at this k.
    error += SHARE * tolerance * abs(value)
    limit = float(
        allowed(ladder, np.array(value), np.asarray(math.hypot(*k)), tolerance)
    )
    if not error <= limit:
        raise ToleranceError(error, limit, "raise `tolerance`")
    return value, error, level


def curvature_of(ladder: SmoothLadder) -> float:
    """About the deviation of κ: of a free fibre, and what the force turns."""
    return math.sqrt(ladder.model.curvature_variance + min(ladder.scales) ** -2)


def far_of(ladder: SmoothLadder) -> float:
    """|k| from which on the limit of short waves is corrected by its next order."""
    turn = ladder.model.curvature_noise ** (2.0 / 3.0)
    curved = FAR_OF_CURVATURE * curvature_of(ladder)
    return float(max(FAR / min(ladder.scales), curved, FAR_OF_NOISE * turn))


def first_of(ladder: SmoothLadder, size: float) -> SmoothBasis:
    """The smallest truncation for a short wave.

    A fibre with the curvature κ stays across k for an angle of √(κ/|k|): the shorter
    the wave, the more harmonics, and polynomials of κ, and the fewer of ξ.
    """
    first, curved = ladder.first, size / curvature_of(ladder)
    octaves = math.log2(max(size * min(ladder.scales) / LONG, 1.0))
    steps = math.ceil(PER_ROOT * math.sqrt(curved) / STEP)
    return SmoothBasis(
        round(max(FEWEST, first.degree - 2 * octaves)),
        first.harmonics + STEP * steps,
        math.ceil(first.curvature * max(1.0, curved) ** 0.25),
    )
