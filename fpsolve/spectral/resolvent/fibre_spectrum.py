"""Ŝ(k) of one fibre and its derivatives at many wave vectors, to a tolerance."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array
from fpsolve.errors import ToleranceError
from fpsolve.spectral.resolvent.basis import Basis
from fpsolve.spectral.resolvent.generator import Generator
from fpsolve.spectral.resolvent.ladder import Ladder
from fpsolve.spectral.resolvent.limit import limit_derivatives, short_wave_limit
from fpsolve.spectral.resolvent.long_limit import NEAR, long_wave_limit, reach_of
from fpsolve.spectral.resolvent.plane_waves import WaveVector
from fpsolve.spectral.resolvent.rest import at_rest, is_round_at_rest
from fpsolve.spectral.resolvent.sensitivity import (
    long_wave_columns,
    short_wave_columns,
)
from fpsolve.spectral.resolvent.waves import along_long_waves, along_short_waves

__all__ = ["fibre_gradient", "fibre_spectrum"]

# |k| σ up to which one factorisation per k1 serves every k2: e^{ik·ξ} needs polynomials
# up to the degree |k σ|² and some more.
LONG = 3.0
# |k| σ, or in units of A²/2, beyond which the law of the angle decides, with a
# correction that is measured there. Before it falls like |k|⁻², it has parts that fall
# like e^{−c √(2|k|/A²)}, and oscillate.
FAR, FAR_OF_NOISE = 300.0, 40.0
# |k| σ up to which sectors serve at rest: Bessel functions of a degree of 40 or so.
LONG_AT_REST = 6.0
# A √σ below which short waves are refused: truncations in a row agree there to 1e-3 on
# what is wrong by a fifth. Against sectors at rest, |k| = 3.2 to 5, the distance was 94
# errors at A = 0.3, 10 at 0.5, 2.1 at 0.6, and at most 0.84 at 0.7. Of long waves three
# truncations must agree there: of two the distance was 11 errors at A = 0.5.
QUIET = 0.7
# Of the tolerance the part that the form of the longest waves may take.
END_SHARE = 0.5
# Degrees count more than harmonics. Of both parities each has half of the states.
FIRST_LONG, MOST_STATES = Basis(14, 7), 40_000
# The first truncation for short waves: its degree, its harmonics, and how they grow
# with |k|, in units of 1/σ or of A²/2: the width of what is left of the angle is about
# |k|^(−1/2).
DEGREE, HARMONICS, PER_ROOT = 8, 5, 1.5


class Method(NamedTuple):
    """What is computed of a generator: a column of values, and maybe of derivatives.

    Attributes
    ----------
    long : callable
        Of a generator, a k1 and many k2, (k2, column).
    short : callable
        Of a generator and a k, (column,).
    law : callable
        The same for the end of short waves.
    n_columns : int
    """

    long: Callable[[Generator, float, Sequence[float]], Array]
    short: Callable[[Generator, WaveVector], Array]
    law: Callable[[Generator, WaveVector], Array]
    n_columns: int


VALUES = Method(
    lambda generator, k1, k2: along_long_waves(generator, k1, k2)[:, None],
    lambda generator, k: np.array([along_short_waves(generator, k)]),
    lambda generator, k: np.array([short_wave_limit(generator, k)]),
    1,
)
GRADIENTS = Method(
    long_wave_columns,
    short_wave_columns,
    lambda generator, k: np.append(
        short_wave_limit(generator, k), limit_derivatives(generator, k)
    ),
    1 + len(Generator.parameters),
)


def fibre_spectrum(
    ladder: Ladder, k1: Array, k2: Array, tolerance: float
) -> tuple[Array, Array]:
    """Ŝ at (k1[i], k2[i]) and bounds of the errors.

    The error is at most `tolerance` times Ŝ, of short waves |k| σ > `LONG` times the
    larger of Ŝ and σ/(1 + |k| σ), σ the smaller throwing range.
    """
    values, errors = _columns(ladder, k1, k2, tolerance, VALUES)
    return values[:, 0], errors[:, 0]


def fibre_gradient(
    ladder: Ladder, k1: Array, k2: Array, tolerance: float
) -> tuple[Array, Array]:
    """Ŝ and its derivatives in `Generator.parameters`, (i, 1 + parameter), with errors.

    Of the truncations that are fine enough for Ŝ to the tolerance: values and their
    errors are those of `fibre_spectrum`, and derivatives have their own.
    """
    return _columns(ladder, k1, k2, tolerance, GRADIENTS)


def _columns(
    ladder: Ladder, k1: Array, k2: Array, tolerance: float, method: Method
) -> tuple[Array, Array]:
    """Ŝ is even in k, and in k2 by reflection: computed once for what differs."""
    points = np.stack([np.abs(k1), np.abs(k2)], axis=1)
    distinct, inverse = np.unique(points, axis=0, return_inverse=True)
    values, errors = np.zeros((2, len(distinct), method.n_columns))
    sigma1, sigma2 = ladder.scales
    by_sectors = method.n_columns == 1 and is_round_at_rest(ladder.model)
    size = np.hypot(distinct[:, 0] * sigma1, distinct[:, 1] * sigma2)
    long = size <= (LONG_AT_REST if by_sectors else LONG)
    others = np.flatnonzero(~long)
    if by_sectors:
        known = waves_at_rest(ladder, distinct, long, tolerance)
    else:
        known = longest_waves(ladder, distinct, tolerance)
    values[:, 0], errors[:, 0], near = known
    if method.n_columns > 1:
        for place in np.flatnonzero(near & distinct.any(axis=1)):
            longest = longest_derivatives(ladder, distinct[place], tolerance, method)
            values[place, 1:], errors[place, 1:] = longest
    long &= ~near
    for one in np.unique(distinct[long, 0]):
        found = np.flatnonzero(long & (distinct[:, 0] == one))
        group = long_waves(ladder, float(one), distinct[found, 1], tolerance, method)
        values[found], errors[found] = group
    level = 0
    # From long to short, since what was fine enough for one is for the next.
    for place in others[np.argsort(np.hypot(*distinct[others].T), kind="stable")]:
        wave = float(distinct[place, 0]), float(distinct[place, 1])
        values[place], errors[place], level = short_wave(
            ladder, wave, tolerance, max(level - 1, 0), method
        )
    inverse = inverse.reshape(-1)
    return values[inverse], errors[inverse]


def floor_of(ladder: Ladder, k: Array) -> Array:
    """σ/(1 + |k| σ): of the size of Ŝ at rest, and never zero."""
    sigma = min(ladder.scales)
    return np.asarray(sigma / (1.0 + k * sigma))


def loudness_of(ladder: Ladder) -> float:
    """A √σ, σ the smaller throwing range."""
    return float(ladder.model.noise * min(ladder.scales) ** 0.5)


def waves_at_rest(
    ladder: Ladder, k: Array, long: NDArray[np.bool_], tolerance: float
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Ŝ of all long waves and bounds of its errors, by sectors; and which these are."""
    values, errors, size = np.zeros(len(k)), np.zeros(len(k)), np.hypot(*k.T)
    asked = long & (size > 0)
    if asked.any():
        values[asked], errors[asked] = at_rest(ladder.model, size[asked], tolerance)
    return values, errors, long


def longest_waves(
    ladder: Ladder, k: Array, tolerance: float
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Ŝ and bounds of its errors by their end, and at which wave vectors it serves."""
    values, errors = np.zeros(len(k)), np.zeros(len(k))
    near = np.hypot(*k.T) <= reach_of(ladder)
    # Of k = 0 nothing is asked: there Ŝ vanishes, and so does its error.
    if near.any() and k[near].any():
        end = long_wave_limit(ladder, FIRST_LONG, END_SHARE * tolerance, MOST_STATES)
        values[near], errors[near] = end(*k[near].T)
        near &= errors <= tolerance * values
    return values, errors, near


def longest_derivatives(
    ladder: Ladder, k: Array, tolerance: float, method: Method
) -> tuple[Array, Array]:
    """Of Ŝ at one k ≠ 0 where it is a quadratic form, from where that ends."""
    ratio = reach_of(ladder) / np.hypot(*k)
    ends = long_waves(ladder, float(k[0] * ratio), k[1:] * ratio, tolerance, method)
    values, errors = (one[0, 1:] / ratio**2 for one in ends)
    # As the form, they lack about the square of `NEAR`.
    return values, errors + 10 * NEAR**2 * np.abs(values)


def allowed(
    ladder: Ladder, found: Array, floor: Array | float, tolerance: float, method: Method
) -> Array:
    """Largest errors of Ŝ, and units in which those of derivatives are told.

    A parameter changes Ŝ by about Ŝ times its own relative change, the speed of the
    belt by Ŝ times its change in units of that of the fibre.
    """
    size = tolerance * np.maximum(np.abs(found[:, :1]), floor)
    units = np.array(
        [1.0, 1.0 / ladder.model.noise, 1.0, *(1.0 / s for s in ladder.scales)]
    )
    return np.asarray(size * units[: method.n_columns])


def long_waves(
    ladder: Ladder, k1: float, k2: Array, tolerance: float, method: Method = VALUES
) -> tuple[Array, Array]:
    """Ŝ at one k1 and many k2, all of one truncation; of little noise of three."""
    values, errors, _ = ladder.climb(
        FIRST_LONG,
        lambda generator: method.long(generator, k1, k2.tolist()),
        lambda found: allowed(ladder, found, 0.0, tolerance, method),
        most=MOST_STATES,
        unseen=np.inf if loudness_of(ladder) < QUIET else None,
    )
    return values, errors


def short_wave(
    ladder: Ladder,
    k: WaveVector,
    tolerance: float,
    level: int = 0,
    method: Method = VALUES,
) -> tuple[Array, Array, int]:
    """Ŝ at one k; beyond `FAR` by the law of the angle and what it lacks there."""
    sigma1, sigma2 = ladder.scales
    loudness = loudness_of(ladder)
    if not loudness >= QUIET:
        raise ToleranceError(
            np.inf, tolerance,
            f"choose a larger noise or longer waves, of which less has to be resolved: "
            f"A √σ is {loudness:.3g}, and below {QUIET:g} two truncations may agree on "
            "short waves that are wrong",
        )  # fmt: skip
    spread = max(1.0, ladder.model.diffusivity * max(sigma1, sigma2))
    far = max(FAR, FAR_OF_NOISE * spread)
    ratio = max(1.0, np.hypot(k[0] * sigma1, k[1] * sigma2) / far)
    nearer = k[0] / ratio, k[1] / ratio
    size = np.hypot(*nearer)
    first = Basis(
        DEGREE,
        round(HARMONICS + PER_ROOT * np.sqrt(size * max(sigma1, sigma2) / spread)),
    )
    floor = float(floor_of(ladder, size))

    def both(generator: Generator) -> Array:
        return np.stack(
            [method.short(generator, nearer), method.law(generator, nearer)]
        )

    values, errors, level = ladder.climb(
        first,
        both,
        lambda found: allowed(ladder, found, floor, tolerance, method),
        level,
    )
    if ratio == 1:
        return values[0], errors[0], level
    # Ŝ |k| = law |k| + correction/|k|² + …, and so for derivatives.
    correction = (values[0] - values[1]) / ratio**2
    value = (values[1] + correction) / ratio
    return value, (errors.max(axis=0) + 2 * np.abs(correction)) / ratio, level
