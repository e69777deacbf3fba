"""Richardson extrapolation from several step lengths, and what it says of errors.

One rule for the equation, its reduced forms and its stationary densities.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache

import numpy as np

from fpsolve._support.arrays import Array, read_only

__all__ = [
    "ROUNDING",
    "extrapolated",
    "extrapolated_series",
    "gain_of",
    "largest_nearby",
    "levelled_series",
    "safety",
    "tableau",
    "weights_of",
]


# Of a number that is summed over a grid, in every step of a run.
ROUNDING = 2e-15


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


@lru_cache(maxsize=16)
def tableau(levels: int) -> tuple[Array, Array]:
    """Weights of the last two entries of Aitken's and Neville's tableau in ds².

    Of u_{ds}, u_{ds/2}, …, u_{ds/n}: the combination of all, of order 2n, and that of
    all but the first, of order 2n − 2; shapes (n,), read-only.
    """
    divisors = range(1, levels + 1)
    best, lower = weights_of(divisors), weights_of(divisors[1:])
    return read_only(np.array(best)), read_only(np.array([0.0, *lower]))


def safety(levels: int) -> float:
    """What the difference of the last two entries of a tableau is multiplied with.

    Where steps are long, at A = 3 and A² ds = 1.5, the last of three or more had an
    error of 1.03 times the difference.
    """
    return 2.0 if levels > 2 else 1.0


def levelled_series(
    runs: Sequence[Mapping[str, Array]],
    reach: float | Array,
    resolved: bool,
    rounding: float,
    approximates: Callable[[str], bool],
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Every series of runs with ds, ds/2, …, ds/n combined, and errors at every s.

    The error is the difference of the last two entries of the tableau, times `safety`,
    which is that of the lower order and covers the higher; where steps are not
    `resolved`, and for series that are not combined, the difference to the run with
    ds/n. Besides it holds
    the `rounding` of a series, relative to its largest value.
    """
    best, lower = tableau(len(runs))
    finest = np.zeros(len(runs))
    finest[-1] = 1.0
    names, s = list(runs[-1]), runs[-1]["s"]
    together = np.array([[one[name] for name in names] for one in runs])
    combined = np.array([approximates(name) for name in names])
    below = np.where(combined & resolved, lower[:, None], finest[:, None])
    change = np.einsum("jm,jmk->mk", best[:, None] - below, together)
    errors = _error(s, safety(len(runs)) * change, reach, 1.0)
    errors += rounding * np.abs(together).max(axis=(0, 2), initial=0.0)[:, None]
    values = np.where(combined[:, None], np.tensordot(best, together, 1), together[-1])
    return dict(zip(names, values, strict=True)), dict(zip(names, errors, strict=True))


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
    errors[..., 0] = (np.broadcast_to(allowed, s.shape) * size)[..., 0]
    return errors


def largest_nearby(s: Array, values: Array, reach: float | Array) -> Array:
    """max of `values` over |s′ − s| ≤ reach, neighbours included; s ascending.

    values (..., n), s (n,).
    """
    n = s.size
    first = np.minimum(np.searchsorted(s, s - reach), np.maximum(np.arange(n) - 1, 0))
    last = np.maximum(np.searchsorted(s, s + reach, "right"), np.arange(n) + 2)
    bounds = np.stack([first, np.minimum(last, n)], axis=1).ravel()
    # An end of its own, since a range must not end behind the array.
    ends = np.full((*values.shape[:-1], 1), -np.inf)
    padded = np.concatenate([values, ends], axis=-1)
    found: Array = np.maximum.reduceat(padded, bounds, axis=-1)[..., ::2]
    return found
