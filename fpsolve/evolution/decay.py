"""Exponential decay rates fitted to a series."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array, check_numbers
from fpsolve._support.checks import shown
from fpsolve.evolution.matrix_pencil import slowest_exponents

__all__ = ["DecayRate", "fit_decay"]


# Below this a relative entropy on a grid is rounding noise.
NOISE_LEVEL = 1e-14
FEWEST = 5
# In the stretch before a window.
FEWEST_BEFORE = 3
# A series has levelled off if its last quarter falls this much slower than another, and
# then only what lies this far above its last value is decay.
LEVEL, CLEAR = 0.2, 100.0
# An error of ln(values) at the end of a window changes a slope by this share of error
# over length, at most: the weight of the last third in a fit by least squares.
LEVER = 1.5
# A rate that has changed by δ from the stretch before a window changes by so many δ yet
# if every further change is two thirds of the last.
TO_COME = 2.0
# A power of s in front is believed if it leaves this share of the scatter.
BETTER = 0.5
# Where the error exceeds this share of the rate, the rate is not resolved.
RESOLVED = 0.5


@dataclass(frozen=True)
class DecayRate:
    """Rate λ of a quantity that falls like C e^{−λs}.

    Attributes
    ----------
    rate, standard_error : float
        λ and an estimate of how far it may be from the rate for s → ∞. The values of a
        run are no independent measurements, so the scatter about the line alone would
        promise too much. Added as squares are that scatter; half the difference between
        the halves of the window; the distance to the slowest of the exponentials of
        which the series is a sum, by fits with three to eight of them, or to a rate
        with a power of s in front if that fits far better; what a level at which the
        series ends may do; and `step_error`.
    amplitude : float
        C.
    window : (float, float)
        Range of s that was used.
    step_error : float
        Part of the error that comes from how the run is resolved; 0 if none is known.
    advice : str
        What to do where the rate is not resolved, else empty.
    """

    rate: float
    standard_error: float
    amplitude: float
    window: tuple[float, float]
    step_error: float = 0.0
    advice: str = ""

    @property
    def resolved(self) -> bool:
        """Whether the error is at most half of the rate; a NaN is not."""
        return self.standard_error <= RESOLVED * abs(self.rate)

    def __str__(self) -> str:
        """Return "0.312 ± 0.004" or "0.31 ± 0.12": no more digits than are known."""
        error = self.standard_error
        digits = 3
        if math.isfinite(error) and error > 0:
            digits = min(max(math.ceil(-math.log10(error / 2)), 0), 6)
        return f"{self.rate:.{digits}f} ± {error:.{digits}f}"


def fit_decay(
    s: Array,
    values: Array,
    window: tuple[float, float] | None = None,
    *,
    errors: Array | None = None,
    step_error: float = 0.0,
) -> DecayRate:
    """λ and C of values ≈ C e^{−λs} by least squares on ln(values).

    Parameters
    ----------
    s, values : ndarray, shape (n,)
    window : (float, float), optional
        Range of s; by default the second half of what lies above rounding noise, and
        well above the level at which the values end, if they do.
    errors : ndarray, shape (n,), optional
        Of the values; what they do to the slope is part of its error.
    step_error : float
        Error of the rate relative to it, where `errors` are not known.

    Raises
    ------
    ValueError
        If fewer than five positive values lie in the window.
    """
    usable = np.isfinite(values) & (values > NOISE_LEVEL)
    # After the first value at noise level nothing later can be trusted.
    trusted = leading_part(usable)
    level = level_of(s[:trusted], values[:trusted])
    if window is None:
        clear = usable & (values > CLEAR * level)
        start, stop = second_half(s, clear) if usable.any() else (0.0, 0.0)
    else:
        start, stop = checked_window(window)
    chosen = usable & (s >= start) & (s <= stop)
    check_number(int(np.count_nonzero(chosen)), (start, stop), level)
    places, logarithms = s[chosen], np.log(values[chosen])
    # scipy.stats.linregress gives the same, and takes half a second to import.
    line, covariance = np.polyfit(places, logarithms, 1, cov=True)
    rate, scatter = -float(line[0]), math.sqrt(covariance[0, 0])
    further = slowest_exponents(places, logarithms, rate)
    # What may be wrong with a straight line, by what it is compared with.
    distance = float(np.max(np.abs(further - rate))) if further.size else 0.0
    distance = max(distance, continuum_distance(places, logarithms, rate))
    shape = math.hypot(scatter, max(bend(places, logarithms) / 2, distance))
    hidden = hidden_error(s[usable], np.log(values[usable]), (start, stop), rate)
    floor = level_error(places, values[chosen], level)
    step = abs(step_error * rate)
    if errors is not None:
        step = math.hypot(step, slope_error(places, values[chosen], errors[chosen]))
    total = math.hypot(shape, hidden, floor, step)
    amplitude = float(np.exp(line[1]))
    found = DecayRate(rate, total, amplitude, (start, stop), step)
    if found.resolved:
        return found
    levels_off = level > 0.0 or bool(further.size and further.min() < LEVEL * rate)
    return replace(found, advice=advice(found, levels_off))


def second_half(s: Array, holds: NDArray[np.bool_]) -> tuple[float, float]:
    """The second half of the arclengths up to the first that does not hold."""
    last = s[max(leading_part(holds) - 1, 0)]
    return float(s[0] + (last - s[0]) / 2), float(last)


def check_number(n: int, window: tuple[float, float], level: float) -> None:
    """Raise ValueError if a window holds too few values, with what would help."""
    if n >= FEWEST:
        return
    remedy = "record more steps, or fit earlier"
    if level > 0.0:
        remedy += (
            f"; the series levels off at {level:.2g}, which `balanced=True` or a "
            "finer grid lowers"
        )
    raise ValueError(
        f"`window` must hold at least {FEWEST} values above {NOISE_LEVEL:g}, got "
        f"{n} in [{window[0]:g}, {window[1]:g}]; {remedy}."
    )


def leading_part(holds: NDArray[np.bool_]) -> int:
    """Number of values before the first that does not hold."""
    return int(np.argmin(holds)) if not holds.all() else holds.size


def level_of(s: Array, values: Array) -> float:
    """The last value if the series has levelled off there, else zero.

    A run on a grid tends to the equilibrium of the grid, of which the entropy is not
    quite zero.
    """
    if s.size < FEWEST:
        return 0.0
    edges = np.linspace(s[0], s[-1], FEWEST)
    slopes = -np.diff(np.interp(edges, s, np.log(values)))
    return float(values[-1]) if slopes[-1] < LEVEL * slopes.max() else 0.0


def continuum_distance(places: Array, logarithms: Array, rate: float) -> float:
    """How far s^{−p} e^{−λs} with p > 0 is from a line; 0 unless it fits far better.

    That is how the modes next to an essential spectrum decay together.
    """
    if places[0] <= 0.0:
        return 0.0
    terms = np.stack([np.ones_like(places), -places, -np.log(places)], axis=1)
    (height, slope, power), *_ = np.linalg.lstsq(terms, logarithms, rcond=None)
    left = np.std(logarithms - terms @ [height, slope, power])
    line = np.polyval(np.polyfit(places, logarithms, 1), places)
    fits = power > 0.0 and left < BETTER * np.std(logarithms - line)
    return abs(float(slope) - rate) if fits else 0.0


def hidden_error(
    s: Array, logarithms: Array, window: tuple[float, float], rate: float
) -> float:
    """What a slower term may change that a window of length T does not tell apart.

    The logarithm of a sum of exponentials that differ by less than 1/T is all but
    straight there. That there is more than one is seen from the rate before, over
    half the length; of one alone the estimate is zero, at most it is 1/T.
    """
    start, stop = window
    length = stop - start
    before = (s >= start - length / 2) & (s <= start)
    if np.count_nonzero(before) < FEWEST_BEFORE:
        # The window is the beginning of the series.
        before = (s >= start) & (s <= start + length / 2)
    if np.count_nonzero(before) < FEWEST_BEFORE:
        return 1.0 / length
    slope = float(np.polyfit(s[before], logarithms[before], 1)[0])
    return min(TO_COME * abs(slope + rate), 1.0 / length)


def level_error(places: Array, values: Array, level: float) -> float:
    """What a level F does to a slope.

    H = ½‖x + y‖² with F = ½‖y‖² contains the product of both, at most 2 √(F H).
    """
    if level == 0.0:
        return 0.0
    share = 2.0 * math.sqrt(level / float(values[-1]))
    return LEVER * math.log1p(share) / float(places[-1] - places[0])


def slope_error(places: Array, values: Array, errors: Array) -> float:
    """Change of the slope if every value is off by its error."""
    shift = np.log1p(np.abs(errors) / values)
    spread = float(np.abs(np.polyfit(places, shift, 1)[0]))
    return spread if math.isfinite(spread) else 0.0


def advice(found: DecayRate, levels_off: bool) -> str:
    """What would resolve a rate."""
    start, stop = found.window
    remedy = f"go on to s = {2 * stop:.3g} or further"
    if levels_off:
        remedy = (
            "the series levels off; use `balanced=True`, which keeps the equilibrium, "
            f"or a finer grid, or else go on to s = {2 * stop:.3g}"
        )
    return (
        f"the rate {found} is not resolved on [{start:.3g}, {stop:.3g}]: {remedy}; "
        "`fp.spectral_gap(model)` gives half of it without a run."
    )


def checked_window(window: Any) -> tuple[float, float]:
    """The two ends as floats; TypeError unless they are two numbers."""
    try:
        start, stop = check_numbers("window", window)
        return float(start), float(stop)
    except (TypeError, ValueError):
        raise TypeError(
            f"`window` must be two arclengths (start, stop), got {shown(window)}."
        ) from None


def bend(places: Array, values: Array) -> float:
    """Difference between the slopes of the two halves of a series."""
    middle = places.size // 2 + 1
    first = np.polyfit(places[:middle], values[:middle], 1)[0]
    second = np.polyfit(places[middle - 2 :], values[middle - 2 :], 1)[0]
    return float(abs(first - second))
