"""B and ∇B at the points where a computation uses them, checked there."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array
from fpsolve.model.potentials.potential import Potential

__all__ = ["gradient_at", "value_at"]

# Further out than this share of the farthest point it is no kink but an overflow.
_FAR = 0.5
_OVERFLOW = "it overflows there: choose a smaller `half_width`"
_KINK = (
    "define it there (`np.where`), or take an even number of cells, so that none has "
    "its centre on a kink"
)


def value_at(
    potential: Potential, xi1: ArrayLike, xi2: ArrayLike, place: str = "cell"
) -> Array:
    """B(ξ), contiguous and finite, in the broadcast shape of the coordinates.

    Parameters
    ----------
    potential : Potential
    xi1, xi2 : array_like
        Points, for instance ``grid.plane()``.
    place : str
        What a point is, for the messages.

    Raises
    ------
    TypeError
        If the values are no real numbers.
    ValueError
        If they have another shape, or one is NaN or infinite: with the point, and
        what helps there.
    """
    values = _filled("value", _called("value", potential.value, xi1, xi2), xi1, xi2)
    if not np.isfinite(values).all():
        raise _not_finite("B", values[None], xi1, xi2, place)
    return values


def gradient_at(
    potential: Potential, xi1: ArrayLike, xi2: ArrayLike, place: str = "cell"
) -> tuple[Array, Array]:
    """∇B(ξ), two contiguous and finite arrays; arguments and errors as `value_at`."""
    pair = _called("gradient", potential.gradient, xi1, xi2)
    if not isinstance(pair, tuple | list | np.ndarray) or len(pair) != 2:
        raise ValueError(
            "`gradient` of the potential must return the pair (dB/dxi1, dB/dxi2), got "
            f"{type(pair).__name__}."
        )
    slope1, slope2 = (_filled("gradient", slope, xi1, xi2) for slope in pair)
    if not (np.isfinite(slope1).all() and np.isfinite(slope2).all()):
        raise _not_finite("∇B", np.stack([slope1, slope2]), xi1, xi2, place)
    return slope1, slope2


def _called(
    name: str, function: Callable[..., Any], xi1: ArrayLike, xi2: ArrayLike
) -> Any:
    try:
        # What overflows is refused afterwards, with the point.
        with np.errstate(all="ignore"):
            return function(xi1, xi2)
    except (TypeError, ValueError, IndexError) as error:
        raise ValueError(
            f"`{name}` of the potential must work elementwise on arrays that "
            f"broadcast, got {type(error).__name__} ({error}) for shapes "
            f"{np.shape(xi1)} and {np.shape(xi2)}."
        ) from error


def _filled(name: str, values: Any, xi1: ArrayLike, xi2: ArrayLike) -> Array:
    shape = np.broadcast_shapes(np.shape(xi1), np.shape(xi2))
    array = np.asarray(values)
    if array.dtype.kind not in "fiub":
        raise TypeError(
            f"`{name}` of the potential must return real numbers, got {array.dtype}."
        )
    try:
        full = array if array.shape == shape else np.broadcast_to(array, shape).copy()
        return np.asarray(full, dtype=np.float64, order="C")
    except ValueError:
        raise ValueError(
            f"`{name}` of the potential must work elementwise, got shape "
            f"{array.shape} for points of shape {shape}."
        ) from None


def _not_finite(
    symbol: str, values: Array, xi1: ArrayLike, xi2: ArrayLike, place: str
) -> ValueError:
    """The error for the first point with NaN or infinity in values[:, point]."""
    finite = np.isfinite(values).all(axis=0)
    index = tuple(int(i) for i in np.argwhere(~finite)[0])
    points = np.broadcast_arrays(xi1, xi2)
    distance = np.hypot(*points)
    far = distance[index] > _FAR * distance.max()
    numbers = ", ".join(f"{number:g}" for number in np.moveaxis(values, 0, -1)[index])
    return ValueError(
        f"`potential` must be finite wherever it is used, got {symbol} = {numbers} at "
        f"xi = ({points[0][index]:g}, {points[1][index]:g}), {place} {index}; "
        f"{_OVERFLOW if far else _KINK}."
    )
