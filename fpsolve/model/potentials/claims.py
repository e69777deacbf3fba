"""What a user's class of potentials says of itself, probed: isotropy and gradient."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array

__all__ = ["ANGLES", "RADII", "central_difference", "check_gradient", "check_isotropy"]

# Radii where the fibre of a dimensionless model lies, and angles in all quadrants;
# none of them round, so that a kink on an axis or at an integer is not hit.
RADII = np.array([0.0531, 0.217, 0.549, 0.893, 1.271, 1.937, 3.113])
ANGLES = np.array([0.37, 1.13, 2.29, 3.01, 3.97, 4.61, 5.83])
# Rounding of B at the two points is far below, another value far above.
_SAME = 1e-9
# Steps of central differences relative to the radius: B may have features of any size.
_STEPS = (1e-5, 1e-3, 1e-7, 1e-9)
# A wrong sign or a forgotten factor is far above; rounding at the last step is below.
_RELATIVE = 1e-2


def check_isotropy(value: Callable[..., Any], size: float) -> None:
    """Raise ValueError if B(r cos θ, r sin θ) is not B(r, 0), for r about `size`."""
    r = size * RADII[:, None]
    with np.errstate(all="ignore"):
        turned = np.asarray(value(r * np.cos(ANGLES), r * np.sin(ANGLES)))
        along = np.asarray(value(r, 0.0 * r))
        away = np.abs(turned - along)
        wrong = away > _SAME * (1.0 + np.abs(turned) + np.abs(along))
    if not wrong.any():
        return
    i, j = np.argwhere(wrong)[0]
    along = np.broadcast_to(along, turned.shape)
    raise ValueError(
        f"`isotropic` must be false unless B depends on the radius alone, got "
        f"B = {turned[i, j]:g} at r = {r[i, 0]:g}, angle {ANGLES[j]:g}, and "
        f"{along[i, j]:g} at angle 0."
    )


def check_gradient(value: Callable[..., Any], gradient: Callable[..., Any]) -> None:
    """Raise ValueError if ∇B is not the derivative of B at places of about size one.

    Places where either is not finite are passed over: B may be defined in a box.
    """
    xi = np.stack([RADII * np.cos(ANGLES), RADII * np.sin(ANGLES)])
    try:
        with np.errstate(all="ignore"):
            slopes, wrong = _compared(value, gradient, xi)
    except Exception:
        # A user's function raises whatever it likes: it is refused where it is used.
        return
    if not wrong.any():
        return
    axis, at = np.argwhere(wrong)[0]
    difference, _ = central_difference(value, xi, int(axis), _STEPS[0] * RADII)
    raise ValueError(
        "`gradient` of the potential must be that of its `value`, got component "
        f"{axis} = {slopes[axis, at]:g} where central differences give "
        f"{difference[at]:g}, at xi = ({xi[0, at]:g}, {xi[1, at]:g})."
    )


def _compared(
    value: Callable[..., Any], gradient: Callable[..., Any], xi: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """∇B, and where it is finite and no difference of B, with none of the steps."""
    slope1, slope2 = gradient(*xi)
    slopes = np.stack(np.broadcast_arrays(slope1, slope2, xi[0])[:2])
    if slopes.dtype.kind not in "iuf":
        raise TypeError
    slopes = slopes.astype(np.float64)
    wrong = np.isfinite(slopes)
    for step in _STEPS:
        differences = [central_difference(value, xi, axis, step * RADII)
                       for axis in (0, 1)]  # fmt: skip
        difference, height = map(np.stack, zip(*differences, strict=True))
        rounding = 1e-14 * (height + 1.0) / (step * RADII)
        size = np.maximum(np.abs(slopes), np.abs(difference))
        wrong &= np.abs(slopes - difference) > _RELATIVE * size + rounding
    return slopes, wrong


def central_difference(
    value: Callable[..., Any],
    points: Array | Sequence[Array],
    axis: int,
    step: Array | float,
) -> tuple[Array, Array]:
    """∂B along an axis, and |B| ahead plus |B| behind, of which it is the difference.

    Parameters
    ----------
    value : callable
    points : sequence of ndarray, shape (n,)
        Coordinates, one after the other.
    axis : int
    step : float or ndarray, shape (n,)
        As it is after rounding, not as it is asked for.
    """
    ahead, behind = list(points), list(points)
    ahead[axis] = points[axis] + step
    behind[axis] = points[axis] - step
    shape = points[0].shape
    high, low = (np.broadcast_to(value(*at), shape) for at in (ahead, behind))
    return (high - low) / (ahead[axis] - behind[axis]), np.abs(high) + np.abs(low)
