"""Ŝ(k) of one smooth fibre at many wave vectors, to a tolerance."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.errors import ToleranceError
from fpsolve.spectral.resolvent.plane_waves import WaveVector
from fpsolve.spectral.resolvent.smooth_basis import SmoothBasis
from fpsolve.spectral.resolvent.smooth_generator import SmoothGenerator
from fpsolve.spectral.resolvent.smooth_ladder import SmoothLadder
from fpsolve.spectral.resolvent.smooth_limit import smooth_short_wave_limit
from fpsolve.spectral.resolvent.smooth_sensitivity import (
    smooth_long_columns,
    smooth_short_columns,
)
from fpsolve.spectral.resolvent.smooth_solutions import (
    along_long_waves,
    along_short_waves,
)

__all__ = ["smooth_gradient", "smooth_spectrum"]

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


class Method(NamedTuple):
    """How Ŝ is computed in one truncation, alone or with its derivatives beside it.

    Attributes
    ----------
    long : callable
        At one k1 and many k2, (k2, column).
    short : callable
        Of a generator, two larger ones with their stationary laws, and a k, (law,
        column).
    limit : callable
        Of a generator and a k the end of short waves, (column,).
    n_columns : int
    """

    long: Callable[[SmoothGenerator, float, Sequence[float]], Array]
    short: Callable[[SmoothGenerator, Sequence[SmoothGenerator], WaveVector], Array]
    limit: Callable[[SmoothGenerator, WaveVector], Array]
    n_columns: int


def short_values(
    generator: SmoothGenerator, laws: Sequence[SmoothGenerator], k: WaveVector
) -> Array:
    """Ŝ by each of the laws."""
    both = [picked(generator, law, law.stationary) for law in laws]
    return along_short_waves(generator, both, k)[:, None]


def short_columns(
    generator: SmoothGenerator, laws: Sequence[SmoothGenerator], k: WaveVector
) -> Array:
    """Ŝ and its derivatives by each of the laws."""
    both = [picked(generator, law, law.stationary) for law in laws]
    changes = [
        np.array([picked(generator, law, one) for one in law.stationary_derivatives])
        for law in laws
    ]
    return smooth_short_columns(generator, both, changes, k)


def limit_columns(generator: SmoothGenerator, k: WaveVector) -> Array:
    """The end of short waves and its derivatives."""
    laws = generator.stationary, *generator.stationary_derivatives
    return np.array([smooth_short_wave_limit(generator, k, law) for law in laws])


def picked(generator: SmoothGenerator, larger: SmoothGenerator, law: Array) -> Array:
    """What a truncation has of a law of a larger one."""
    return np.asarray(generator.basis.picked(larger.basis.table(law)))


VALUES = Method(
    lambda generator, k1, k2: along_long_waves(generator, k1, k2)[:, None],
    short_values,
    lambda generator, k: np.array([smooth_short_wave_limit(generator, k)]),
    1,
)
GRADIENTS = Method(
    smooth_long_columns,
    short_columns,
    limit_columns,
    1 + len(SmoothGenerator.parameters),
)


def smooth_spectrum(
    ladder: SmoothLadder, k1: Array, k2: Array, tolerance: float
) -> tuple[Array, Array]:
    """Ŝ at (k1[i], k2[i]) and bounds of the errors.

    Ŝ is even in k1 and in k2: computed once for what differs. The error is at most
    `tolerance` times the larger of Ŝ and σ/(1 + |k| σ), σ the smaller throwing range.
    """
    values, errors = _columns(ladder, k1, k2, tolerance, VALUES)
    return values[:, 0], errors[:, 0]


def smooth_gradient(
    ladder: SmoothLadder, k1: Array, k2: Array, tolerance: float
) -> tuple[Array, Array]:
    """Ŝ and its derivatives in `SmoothGenerator.parameters`, (i, 1 + parameter).

    With bounds of the errors. Of the truncations that are fine enough for Ŝ to the
    tolerance: values and their errors are those of `smooth_spectrum`, and derivatives
    have their own.
    """
    return _columns(ladder, k1, k2, tolerance, GRADIENTS)


def _columns(
    ladder: SmoothLadder, k1: Array, k2: Array, tolerance: float, method: Method
) -> tuple[Array, Array]:
    points = np.stack([np.abs(k1), np.abs(k2)], axis=1)
    distinct, inverse = np.unique(points, axis=0, return_inverse=True)
    values, errors = np.zeros((2, len(distinct), method.n_columns))
    long = np.hypot(*(distinct * ladder.spreads).T) <= LONG
    level = 0
    for one in np.unique(distinct[long, 0]):
        found = np.flatnonzero(long & (distinct[:, 0] == one))
        values[found], errors[found], level = long_waves(
            ladder, float(one), distinct[found, 1], tolerance, max(level - 2, 0), method
        )
    level, others = 0, np.flatnonzero(~long)
    # From long to short, since what was fine enough for one is for the next.
    for place in others[np.argsort(np.hypot(*distinct[others].T), kind="stable")]:
        wave = float(distinct[place, 0]), float(distinct[place, 1])
        values[place], errors[place], level = short_wave(
            ladder, wave, tolerance, max(level - 2, 0), method
        )
    inverse = inverse.reshape(-1)
    return values[inverse], errors[inverse]


def units(ladder: SmoothLadder, method: Method) -> Array:
    """Of Ŝ and its derivatives: a parameter changes Ŝ by about its own relative change.

    The speed of the belt by its change in units of that of the fibre.
    """
    model = ladder.model
    lengths = *ladder.scales, model.relaxation_length
    every = np.array([1.0, 1.0 / model.noise, 1.0, *(1.0 / one for one in lengths)])
    return every[: method.n_columns]


def allowed(
    ladder: SmoothLadder, found: Array, k: Array, tolerance: float, method: Method
) -> Array:
    """The largest errors of what was found, (wave, column)."""
    sigma = min(ladder.scales)
    size = np.maximum(np.abs(found[:, :1]), sigma / (1.0 + k[:, None] * sigma))
    return np.asarray(tolerance * size * units(ladder, method))


def long_waves(
    ladder: SmoothLadder,
    k1: float,
    k2: Array,
    tolerance: float,
    level: int = 0,
    method: Method = VALUES,
) -> tuple[Array, Array, int]:
    """Ŝ at one k1 and many k2, all of one truncation."""
    return ladder.climb(
        ladder.first,
        lambda generator: method.long(generator, k1, k2.tolist()),
        lambda found: allowed(ladder, found, np.hypot(k1, k2), tolerance, method),
        level,
        MOST_LONG,
    )


def short_wave(
    ladder: SmoothLadder,
    k: tuple[float, float],
    tolerance: float,
    level: int = 0,
    method: Method = VALUES,
) -> tuple[Array, Array, int]:
    """Ŝ at one k; far away by the law of the angle and what it lacks nearer."""
    ratio = max(1.0, math.hypot(*k) / far_of(ladder))
    nearer = k[0] / ratio, k[1] / ratio
    size = math.hypot(*nearer)
    laws = ladder.laws(SHARE * tolerance)
    sizes = np.full(len(laws), size)
    values, errors, level = ladder.climb(
        first_of(ladder, size),
        lambda generator: method.short(generator, laws, nearer),
        lambda found: allowed(ladder, found, sizes, (1 - SHARE) * tolerance, method),
        level, MOST_SHORT,
    )  # fmt: skip
    value, error = values[0], errors[0] + 2 * np.abs(values[0] - values[1])
    if ratio > 1:
        # Ŝ |k| = that of the limit + correction/|k|⁴ + …
        correction = (value - method.limit(laws[0], nearer)) / ratio**5
        value = method.limit(laws[0], k) + correction
        error = 2 * np.abs(correction) + error / ratio**5
    # What two truncations of the law may differ by, whatever they do at this k.
    of_law = np.maximum(np.abs(value), np.abs(value[0]) * units(ladder, method))
    error = error + SHARE * tolerance * of_law
    limit = allowed(ladder, value[None], np.array([math.hypot(*k)]), tolerance, method)
    if not error[0] <= limit[0, 0]:
        raise ToleranceError(float(error[0]), float(limit[0, 0]), "raise `tolerance`")
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
