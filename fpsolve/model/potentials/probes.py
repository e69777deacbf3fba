"""Probing a user's functions: elementwise, real, finite, and each other's derivative.

A wrong sign in a gradient gives a run that looks fine and converges to nothing; it is
cheap to notice here.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.model.potentials.claims import ANGLES, RADII, central_difference

__all__ = ["check_plane_functions", "check_radial_functions"]

# Optimal step of a central difference in double precision; its error is then about
# 1e-10 of the size of B, far below the tolerances.
_STEP = float(np.finfo(np.float64).eps ** (1 / 3))
_RELATIVE_TOLERANCE = 1e-4
_ABSOLUTE_TOLERANCE = 1e-6

_Function = Callable[..., Any]


def check_radial_functions(value: _Function, derivative: _Function) -> None:
    """Raise unless `derivative` is B' of `value` = B at the probe radii."""
    values = _probe("value", value, (RADII,))
    slopes = _probe("derivative", derivative, (RADII,))
    _compare("derivative", slopes, value, (RADII,), 0, np.abs(values))


def check_plane_functions(value: _Function, gradient: _Function) -> None:
    """Raise unless `gradient` is ∇B of `value` = B at the probe points."""
    points = RADII * np.cos(ANGLES), RADII * np.sin(ANGLES)
    values = _probe("value", value, points)
    for axis, slopes in enumerate(_probe_pair(gradient, points)):
        name = f"gradient[{axis}]"
        _compare(name, slopes, value, points, axis, np.abs(values))


def _probe(name: str, function: _Function, points: tuple[Array, ...]) -> Array:
    _require_callable(name, function)
    return _checked_values(name, _called(name, function, points), points)


def _probe_pair(gradient: _Function, points: tuple[Array, ...]) -> list[Array]:
    _require_callable("gradient", gradient)
    slopes = _called("gradient", gradient, points)
    if not isinstance(slopes, tuple | list | np.ndarray) or len(slopes) != 2:
        raise ValueError(
            "`gradient` must return the pair (dB/dxi1, dB/dxi2), "
            f"got {type(slopes).__name__}."
        )
    return [
        _checked_values(f"gradient[{axis}]", slope, points)
        for axis, slope in enumerate(slopes)
    ]


def _require_callable(name: str, function: Any) -> None:
    if not callable(function):
        raise TypeError(f"`{name}` must be callable, got {function!r}.")


def _called(name: str, function: _Function, points: tuple[Array, ...]) -> Any:
    try:
        return function(*points)
    except (TypeError, ValueError) as error:
        raise ValueError(
            f"`{name}` must work elementwise on {len(points)} array(s), but raised "
            f"{type(error).__name__}: {error}; use numpy functions and `np.where`."
        ) from error


def _checked_values(name: str, values: Any, points: tuple[Array, ...]) -> Array:
    array = np.asarray(values)
    if array.dtype.kind not in "fiub":
        raise TypeError(f"`{name}` must return real numbers, got {array.dtype}.")
    if array.shape not in ((), points[0].shape):
        raise ValueError(
            f"`{name}` must work elementwise, got shape {array.shape} for arguments "
            f"of shape {points[0].shape}."
        )
    array = np.broadcast_to(array, points[0].shape).astype(np.float64)
    for number, point in zip(array, zip(*points, strict=True), strict=True):
        if not np.isfinite(number):
            raise ValueError(
                f"`{name}` must be finite, got {number:g} at {_point_text(point)}."
            )
    return array


def _compare(
    name: str,
    slopes: Array,
    value: _Function,
    points: tuple[Array, ...],
    axis: int,
    size: Array,
) -> None:
    """Raise where the slopes are not the differences of `value` along `axis`."""
    differences, _ = central_difference(value, points, axis, _STEP)
    allowed = _RELATIVE_TOLERANCE * np.maximum(np.abs(slopes), np.abs(differences))
    allowed += _ABSOLUTE_TOLERANCE * (1 + size)
    deviation = np.abs(slopes - differences)
    for at in range(deviation.size):
        if not deviation[at] <= allowed[at]:
            point = tuple(coordinate[at] for coordinate in points)
            raise ValueError(
                f"`{name}` must be the derivative of `value`, got {slopes[at]:g} "
                f"where central differences give {differences[at]:g} at "
                f"{_point_text(point)}."
            )


def _point_text(point: tuple[float, ...]) -> str:
    if len(point) == 1:
        return f"r = {point[0]:g}"
    return f"xi = ({point[0]:g}, {point[1]:g})"
