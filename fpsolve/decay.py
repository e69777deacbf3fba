"""Exponential decay rates fitted to a series."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._arrays import check_numbers
from fpsolve._checks import shown

__all__ = ["DecayRate", "fit_decay"]

Array = NDArray[np.float64]

# Below this a relative entropy on a grid is rounding noise.
NOISE_LEVEL = 1e-14
FEWEST = 5


@dataclass(frozen=True)
class DecayRate:
    """Rate λ of a quantity that falls like C e^{−λs}.

    Attributes
    ----------
    rate, standard_error : float
        λ and how straight the decay is on the window: the standard error of the fit
        and half the difference between its two halves, added as squares. The values
        of a run are no independent measurements, so the scatter about the line alone
        would promise too much where the decay still bends or oscillates. It does not
        say how well the run is resolved.
    amplitude : float
        C.
    window : (float, float)
        Range of s that was used.
    """

    rate: float
    standard_error: float
    amplitude: float
    window: tuple[float, float]

    def __str__(self) -> str:
        """Return "0.312 ± 0.004" or "0.31 ± 0.12": no more digits than are known."""
        error = self.standard_error
        digits = 3
        if math.isfinite(error) and error > 0:
            digits = min(max(math.ceil(-math.log10(error / 2)), 0), 6)
        return f"{self.rate:.{digits}f} ± {error:.{digits}f}"


def fit_decay(
    s: Array, values: Array, window: tuple[float, float] | None = None
) -> DecayRate:
    """λ and C of values ≈ C e^{−λs} by least squares on ln(values).

    Parameters
    ----------
    s, values : ndarray, shape (n,)
    window : (float, float), optional
        Range of s; by default the second half of what lies above rounding noise.

    Raises
    ------
    ValueError
        If fewer than five positive values lie in the window.
    """
    usable = np.isfinite(values) & (values > NOISE_LEVEL)
    if window is None and usable.any():
        # After the first value at noise level nothing later can be trusted.
        first_bad = np.argmin(usable) if not usable.all() else usable.size
        last = s[max(first_bad - 1, 0)]
        window = (float(s[0] + (last - s[0]) / 2), float(last))
    start, stop = (0.0, 0.0) if window is None else checked_window(window)
    chosen = usable & (s >= start) & (s <= stop)
    if np.count_nonzero(chosen) < FEWEST:
        raise ValueError(
            f"`window` must hold at least {FEWEST} values above {NOISE_LEVEL:g}, got "
            f"{np.count_nonzero(chosen)} in [{start:g}, {stop:g}]; record more "
            "steps, or fit earlier."
        )
    places, logarithms = s[chosen], np.log(values[chosen])
    # scipy.stats.linregress gives the same, and takes half a second to import.
    line, covariance = np.polyfit(places, logarithms, 1, cov=True)
    scatter = math.sqrt(covariance[0, 0])
    return DecayRate(
        rate=-float(line[0]),
        standard_error=math.hypot(scatter, bend(places, logarithms) / 2),
        amplitude=float(np.exp(line[1])),
        window=(start, stop),
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
