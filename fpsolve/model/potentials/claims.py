"""What a user's class of potentials says of itself, probed: isotropy and gradient."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["check_gradient", "check_isotropy"]

Array = NDArray[np.float64]

# None of them round, so that a kink on an axis or at an integer is not hit.
_RADII = np.array([0.0531, 0.217, 0.549, 0.893, 1.271, 1.937, 3.113])
_ANGLES = np.array([0.37, 1.13, 2.29, 3.01, 3.97, 4.61, 5.83])
# Rounding of B at the two points is far below, another value far above.
_SAME = 1e-9
# Steps of central differences relative to the radius: B may have features of any size.
_STEPS = (1e-5, 1e-3, 1e-7, 1e-9)
# A wrong sign or a forgotten factor is far above; rounding at the last step is below.
_RELATIVE = 1e-2


def check_isotropy(value: Callable[..., Any], size: float) -> None:
    """Raise ValueError if B(r cos θ, r sin θ) is not B(r, 0), for r about `size`."""
    r = size * _RADII[:, None]
    with np.errstate(all="ignore"):
        turned = np.asarray(value(r * np.cos(_ANGLES), r * np.sin(_ANGLES)))
        along = np.asarray(value(r, 0.0 * r))
        away = np.abs(turned - along)
        wrong = away > _SAME * (1.0 + np.abs(turned) + np.abs(along))
    if not wrong.any():
        return
    i, j = np.argwhere(wrong)[0]
    along = np.broadcast_to(along, turned.shape)
    raise ValueError(
        f"`isotropic` must be false unless B depends on the radius alone, got "
        f"B = {turned[i, j]:g} at r = {r[i, 0]:g}, angle {_ANGLES[j]:g}, and "
        f"{along[i, j]:g} at angle 0."
    )


def check_gradient(value: Callable[..., Any], gradient: Callable[..., Any]) -> None:
    """Raise ValueError if ∇B is not the derivative of B at places of about size one.

    Places where either is not finite are passed over: B may be defined in a box.
    """
    xi = np.stack([_RADII * np.cos(_ANGLES), _RADII * np.sin(_ANGLES)])
    try:
        with np.errstate(all="ignore"):
            slopes, wrong = _compared(value, gradient, xi)
    except Exception:
        # A user's function raises whatever it likes: it is refused where it is used.
        return
    if not wrong.any():
        return
    axis, at = np.argwhere(wrong)[0]
    difference, _ = _central_differences(value, xi, _STEPS[0] * _RADII)
    raise ValueError(
        "`gradient` of the potential must be that of its `value`, got component "
        f"{axis} = {slopes[axis, at]:g} where central differences give "
        f"{difference[axis, at]:g}, at xi = ({xi[0, at]:g}, {xi[1, at]:g})."
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
        difference, rounding = _central_differences(value, xi, step * _RADII)
        size = np.maximum(np.abs(slopes), np.abs(difference))
        wrong &= np.abs(slopes - difference) > _RELATIVE * size + rounding
    return slopes, wrong


def _central_differences(
    value: Callable[..., Any], xi: Array, step: Array
) -> tuple[Array, Array]:
    """∂B by differences, and what of it may be rounding; shapes (2, n)."""
    found, rounding = [], []
    for axis in (0, 1):
        ahead, behind = xi.copy(), xi.copy()
        ahead[axis] += step
        behind[axis] -= step
        high, low = (np.broadcast_to(value(*at), step.shape) for at in (ahead, behind))
        found.append((high - low) / (ahead[axis] - behind[axis]))
        rounding.append(1e-14 * (np.abs(high) + np.abs(low) + 1.0) / step)
    return np.stack(found), np.stack(rounding)
