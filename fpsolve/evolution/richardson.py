"""Richardson extrapolation from several step lengths, and what it says of errors.

One rule for the equation, its reduced forms and its stationary densities.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from fpsolve._support.arrays import Array

__all__ = [
    "extrapolated",
    "extrapolated_series",
    "gain_of",
    "largest_nearby",
    "weights_of",
]


def gain_of(order: int) -> float:
    """1/(2^q − 1): error of u_{ds/2} relative to u_{ds/2} − u_{ds}, of order q."""
    return 1.0 / float(2**order - 1)


def extrapolated(fine: Array, coarse: Array, gain: float) -> Array:
    """u = (2^q u_{ds/2} − u_{ds})/(2^q − 1), from both and the gain of the order."""
    combined: Array = fine + gain * (fine - coarse)
    return combined


def weights_of(divisors: Sequence[int]) -> list[float]:
    """w_j with Σ w_j = 1 and Σ w_j j^{−2m} = 0 for m = 1, …: no such powers of ds.

    For u_{ds/j} with an error of even powers of ds (Neville); (1, 2) has the weights of
    order two, −gain and 1 + gain.
    """
    squares = [float(j) ** 2 for j in divisors]
    return [
        float(np.prod([one / (one - other) for other in squares if other != one]))
        for one in squares
    ]


def extrapolated_series(
    fine: Mapping[str, Array],
    coarse: Mapping[str, Array],
    gain: float,
    reach: float | Array,
    allowed: float | Array,
    approximates: Callable[[str], bool],
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Every series of two runs combined, and the error of the finer at every s.

    Where the change of a series, the difference of the two, goes through zero it says
    nothing: the estimate is the largest nearby, but at the start, which both share.

    Parameters
    ----------
    fine, coarse : mapping of ndarray, shape (n,)
        The series of the runs with ds/2 and ds; "s" is where.
    gain : float
        `gain_of` the order.
    reach : float or ndarray, shape (n,)
        Half width of what is near; neighbours are.
    allowed : float or ndarray, shape (n,)
        The error relative to the change: the gain where an expansion in ds holds.
    approximates : callable
        Whether a series approximates something that does not depend on ds; others stay
        those of the finer run.
    """
    series, errors = dict(fine), {}
    for name, values in fine.items():
        errors[name] = _error(fine["s"], values - coarse[name], reach, allowed)
        if approximates(name):
            series[name] = extrapolated(values, coarse[name], gain)
    return series, errors


def _error(
    s: Array, change: Array, reach: float | Array, allowed: float | Array
) -> Array:
    size = np.abs(change)
    errors: Array = allowed * largest_nearby(s, size, reach)
    errors[0] = (np.broadcast_to(allowed, s.shape) * size)[0]
    return errors


def largest_nearby(s: Array, values: Array, reach: float | Array) -> Array:
    """max of `values` over |s′ − s| ≤ reach, neighbours included; s ascending."""
    n = s.size
    first = np.minimum(np.searchsorted(s, s - reach), np.maximum(np.arange(n) - 1, 0))
    last = np.maximum(np.searchsorted(s, s + reach, "right"), np.arange(n) + 2)
    bounds = np.stack([first, np.minimum(last, n)], axis=1).ravel()
    # An end of its own, since a range must not end behind the array.
    padded = np.append(values, -np.inf)
    found: Array = np.maximum.reduceat(padded, bounds)[::2]
    return found
