"""Strips along or across the machine: the strongest wave of the mean profile."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array, Complex
from fpsolve._support.checks import check_one_of, check_positive
from fpsolve.web.statistics.blocks import FEWEST_BLOCKS, Blocks, cut
from fpsolve.web.statistics.correlation import memory
from fpsolve.web.statistics.estimate import Estimate
from fpsolve.web.statistics.fields import check_density
from fpsolve.web.statistics.jackknife import variance_and_bias

__all__ = ["Strips", "strips"]

# Independent stretches of the web, at most, and their length in correlation lengths.
_STRETCHES, _CORRELATION_LENGTHS = 64, 3.0
# Frequencies looked at per resolved one: the best is then met to 2 % of its power.
_OVERSAMPLED = 4
# Periods that a web must hold, for a period to be one.
_FEWEST_PERIODS = 2
# Resolved frequencies on either side of one, whose memories are averaged: that of a
# single wave is known badly, and the strongest is the one that seems to forget early.
_NEIGHBOURS = 4
# By which a mean that is taken off a series of length L shortens a memory ℓ: what is
# found is ℓ (1 - 4 ℓ/L) or so where four stretches just fit.
_SHORTENED = 4.0
# Halvings of the distance to the best frequency: 1e-6 of what is resolved.
_HALVINGS = 20
# Place of the share among the numbers that are measured.
_SHARE = 2


@dataclass(frozen=True)
class Strips:
    """The strongest wave of a profile, m(y)/⟨m⟩ = 1 + a cos(2π y/period + phase) + ….

    Parameters
    ----------
    period : Estimate
        Distance of strips.
    amplitude : Estimate
        a, the power N of the noise taken off its square. Its error is that of the
        stretches, or √(a² + δ) - a with the deviation δ² = N² + 2 a² N of |c|², if
        that is larger: where nothing is left of a, stretches agree about it.
    share : Estimate
        a²/2 over CV² of the profile, the noise of this web in it; its error is at least
        that due to δ.
    p_value : float
        Probability that noise alone has a wave this strong among all that were
        looked at; NaN where there are fewer than 4 stretches.
    direction : str
        Along which strips run, "machine" or "cross".
    """

    period: Estimate
    amplitude: Estimate
    share: Estimate
    p_value: float
    direction: str


def strips(
    length_density: Any,
    pixel: float,
    *,
    direction: str = "machine",
    period: float | None = None,
    block: float | None = None,
) -> Strips:
    """Maximise |c(k)|, c(k) = 2 n⁻¹ Σ_j (M_j/⟨M⟩ - 1) e^{-ik y_j}, M the mean profile.

    The web is cut into independent stretches across the strips. Their c scatter, which
    tells noise from strips: without any, |c|² over the scatter has the law
    F(2, 2(n - 1)) at one frequency, and `p_value` counts all frequencies (Bonferroni).
    What neighbouring stretches share is made up for in scatter and errors.
    A web cannot tell a strip from a memory as long as itself: where the memory found
    is longer than a sixteenth of it, fewer than 4 stretches are independent, and errors
    and `p_value` are NaN, with a reason. Of webs without strips about one in a hundred
    has p < 0.01, however long they remember.
    A strongest wave exists in every web; without a small `p_value` it is noise, and its
    amplitude the largest of many.

    Parameters
    ----------
    length_density, pixel
        As for `coefficient_of_variation`.
    direction : {"machine", "cross"}
        Along which the strips run: in machine direction for the distance of nozzles, in
        cross direction for nozzles that turn or swing in phase.
    period : float, optional
        The period, if it is known; by default the strongest is looked for, from two
        pixels to half the web.
    block : float, optional
        Length of a stretch; by default three correlation lengths of the waves near
        the strongest one along the strips, and a 64th of the web at least. Stretches
        of a given length are taken for independent.

    Returns
    -------
    Strips

    Raises
    ------
    TypeError, ValueError
        As for `coefficient_of_variation`; if the period is not between two pixels and
        half the web, which must hold 8 pixels.
    """
    density, pixel = check_density(length_density, pixel)
    check_one_of("direction", direction, ("machine", "cross"))
    if direction == "cross":
        density = density.T
    search = _Search(density.shape[0], pixel, period)
    start = search.strongest(density.mean(axis=1))
    lasting = 0.0 if block is not None else _lasting(density, search, start)
    if block is None:
        longest = pixel * density.shape[1]
        block = min(pixel + _CORRELATION_LENGTHS * lasting, longest)
    profiles, blocks = _profiles(density, pixel, block, lasting)
    sizes, inflation = blocks.sizes, blocks.inflation
    means = profiles / sizes[:, None]
    noise, p_value = _against_noise(means, search, start, inflation)
    values, variances, biases = variance_and_bias(
        lambda means: search.measured(means, start, noise), profiles, sizes
    )
    # The share is that of the profile of this web, with its noise.
    biases[_SHARE] = 0.0
    errors = np.sqrt(variances + biases**2)
    least = _errors_of_noise(values, noise, density.mean(axis=1))
    errors = np.maximum(math.sqrt(inflation) * errors, least)
    found = [
        Estimate(value, error, blocks.n_blocks, density.shape[0], blocks.reason)
        for value, error in zip(values, errors, strict=True)
    ]
    return Strips(found[0], found[1], found[2], p_value, direction)


def _lasting(density: Array, search: _Search, frequency: float) -> float:
    """Return ℓ - x of the waves near one, along the strips; infinite if not to be had.

    A mean that is taken off hides the end of a memory, which is made up for.
    """
    waves = search.wave(density.T, search.neighbours(frequency))
    found = memory(waves, search.pixel)
    left = 1.0 - _SHORTENED * found / (search.pixel * density.shape[1])
    return found / left if left > 0 else math.inf


def _profiles(
    density: Array, pixel: float, block: float, lasting: float
) -> tuple[Array, Blocks]:
    """Return the summed profile of every stretch, and the stretches as blocks.

    Stretches of length D leave 1 - (ℓ - x)/(2 D) of the variance of a mean.
    """
    n = density.shape[1]
    side = max(check_positive("block", block), pixel * n / _STRETCHES)
    # One cell per column, which holds the whole profile.
    stretches = cut((1, n), pixel, (pixel, max(side, pixel)))
    count = stretches.counts[1]
    starts = np.arange(count) * n // count
    shared = min(lasting * count / (2.0 * pixel * n), 0.5)
    stretches = replace(stretches, inflation=1.0 / (1.0 - shared))
    return np.add.reduceat(density, starts, axis=1).T, stretches


def _against_noise(
    profiles: Array, search: _Search, frequency: float, inflation: float
) -> tuple[float, float]:
    """Return the power of the noise in the mean |c|², and the p value of its wave."""
    from scipy.stats import f

    n = len(profiles)
    if n < FEWEST_BLOCKS:
        return 0.0, float("nan")
    waves = search.wave(profiles / profiles.mean(), frequency)
    scatter = float(np.sum(np.abs(waves - waves.mean()) ** 2)) / (n - 1)
    # Equal stretches, as of a web that was made up.
    if scatter == 0.0:
        return 0.0, 0.0 if abs(waves.mean()) > 0 else 1.0
    scatter *= inflation
    ratio = n * abs(waves.mean()) ** 2 / scatter
    return scatter / n, min(1.0, search.n_tried * float(f.sf(ratio, 2, 2 * (n - 1))))


def _errors_of_noise(values: Array, noise: float, profile: Array) -> Array:
    """Errors of period, amplitude and share that the deviation of |c|² makes."""
    _, amplitude, share = values
    deviation = np.sqrt(noise**2 + 2 * amplitude**2 * noise)
    variance = float(np.var(profile / profile.mean()))
    # The variance of the profile grows with the power of the wave.
    of_share = deviation / 2 * (1.0 - share) / variance if variance > 0 else 0.0
    of_amplitude = np.sqrt(amplitude**2 + deviation) - amplitude
    return np.array([0.0, of_amplitude, max(of_share, 0.0)])


class _Search:
    """Frequencies that a profile of n pixels can tell apart, or a single one."""

    def __init__(self, n: int, pixel: float, period: float | None) -> None:
        self.n, self.pixel, self.places = n, pixel, pixel * (np.arange(n) + 0.5)
        self.spacing = 1.0 / (n * pixel * _OVERSAMPLED)
        shortest, longest = 2.0 * pixel, n * pixel / _FEWEST_PERIODS
        if n < 4 * _FEWEST_PERIODS:
            raise ValueError(
                f"`length_density` must hold {4 * _FEWEST_PERIODS} pixels or more "
                f"across the strips, got {n}."
            )
        self.given = period is not None
        if period is not None:
            period = check_positive("period", period)
            if not shortest <= period <= longest:
                raise ValueError(
                    f"`period` must lie between two pixels, {shortest:g}, and half the "
                    f"web, {longest:g}, got {period:g}."
                )
            self.frequencies = np.array([1.0 / period])
        else:
            first = _FEWEST_PERIODS * _OVERSAMPLED
            numbers = np.arange(first, n * _OVERSAMPLED // 2 + 1)
            self.frequencies = self.spacing * numbers

    @property
    def n_tried(self) -> int:
        """Number of frequencies looked at."""
        return len(self.frequencies)

    def neighbours(self, frequency: float) -> Array:
        """Return those nearest to one of which n pixels hold whole periods."""
        nearest, last = round(frequency * self.n * self.pixel), self.n // 2
        first = max(_FEWEST_PERIODS, nearest - _NEIGHBOURS)
        numbers = np.arange(first, min(last, nearest + _NEIGHBOURS) + 1)
        return np.asarray(numbers / (self.n * self.pixel))

    def wave(self, profiles: Array, frequency: Any) -> Complex:
        """Return c of profiles on the last axis, each less its mean, there frequencies.

        A single frequency has no axis.
        """
        turns = np.exp(-2j * np.pi * np.multiply.outer(self.places, frequency))
        centred = profiles - profiles.mean(axis=-1, keepdims=True)
        return np.asarray(2.0 / self.n * centred @ turns)

    def strongest(self, profile: Array) -> float:
        """Return the frequency of the largest |c|, of all or near the best of them."""
        if self.given:
            return float(self.frequencies[0])
        centred = profile - profile.mean()
        waves = np.fft.rfft(centred, self.n * _OVERSAMPLED)
        first = _FEWEST_PERIODS * _OVERSAMPLED
        best = int(np.argmax(np.abs(waves[first:])))
        return self.refined(profile, float(self.frequencies[best]))

    def refined(self, profile: Array, frequency: float) -> float:
        """Return the frequency of the largest |c| near another one, by bisection."""
        if self.given:
            return frequency
        step = self.spacing
        for _ in range(_HALVINGS):
            tried = frequency + step * np.array([-1.0, 0.0, 1.0])
            powers = np.abs(self.wave(profile, tried))
            frequency, step = float(tried[int(np.argmax(powers))]), step / 2
        return frequency

    def measured(self, means: Array, start: float, noise: float) -> Array:
        """Return period, amplitude and share of profiles on the last axis."""
        rows = [self._one(row, start, noise) for row in np.atleast_2d(means)]
        return np.array(rows).reshape(*means.shape[:-1], 3)

    def _one(self, profile: Array, start: float, noise: float) -> Array:
        frequency = self.refined(profile, start)
        relative = profile / profile.mean()
        power = float(abs(self.wave(relative, frequency))) ** 2
        square = max(power - noise, 0.0)
        variance = float(np.var(relative))
        share = square / 2 / variance if variance > 0 else 0.0
        return np.array([1.0 / frequency, np.sqrt(square), share])
