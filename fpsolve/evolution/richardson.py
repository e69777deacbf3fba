"""Richardson extrapolation of series from two step lengths, and what it says of errors.

One rule for the equation and for its reduced forms.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["error_of_series", "gain_of", "largest_nearby"]

Array = NDArray[np.float64]


def gain_of(order: int) -> float:
    """1/(2^q − 1): error of u_{ds/2} relative to u_{ds/2} − u_{ds}, of order q."""
    return 1.0 / float(2**order - 1)


def error_of_series(
    s: Array, change: Array, reach: float | Array, allowed: float | Array
) -> Array:
    """Error of u_{ds/2} at every s from its change, the difference to u_{ds}.

    Where the change goes through zero it says nothing: the estimate is the largest
    nearby, but at the start, which both runs share.

    Parameters
    ----------
    s, change : ndarray, shape (n,)
    reach : float or ndarray, shape (n,)
        Half width of what is near; neighbours are.
    allowed : float or ndarray, shape (n,)
        The error relative to the change: `gain_of` the order where an expansion in ds
        holds.
    """
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
