"""Which models have one stationary density, and which steps reach it."""

from __future__ import annotations

import math

import numpy as np
from scipy.special import i0e, i1e

from fpsolve._support.checks import check_real
from fpsolve.model.laydown import LayDownModel

__all__ = ["check_stationary", "checked_step"]

# A stride of more steps than this would never end.
SHORTEST = 1e-9
# Where the slope of B is its slope far out.
FAR = 1e6


def checked_step(ds: float) -> float:
    """The step as a float, positive and not so short that no unit of s is reached."""
    ds = check_real("ds", ds)
    if not (math.isfinite(ds) and ds > 0):
        raise ValueError(f"`ds` must be positive, got {ds:g}.")
    if not ds >= SHORTEST:
        raise ValueError(
            f"`ds` must be at least {SHORTEST:g}, got {ds:g}; one evaluation goes over "
            "about a unit of arclength."
        )
    return ds


def check_stationary(model: LayDownModel) -> None:
    """Raise ValueError if the model has no stationary density, or many."""
    if not model.curve.autonomous:
        raise ValueError(
            f"`curve` must move at constant speed, got {model.curve!r}; under a "
            "rotating or oscillating nozzle the density never comes to rest."
        )
    if not model.potential.normalisable:
        raise ValueError(
            f"`potential` must confine, got {model.potential!r}: exp(-B) has no "
            "finite integral."
        )
    if not model.noise > 0:
        raise ValueError(
            "`noise` must be positive, got 0; without noise there are many stationary "
            "densities on a fixed belt, `initial.equilibrium` among them, and none is "
            "reached on a moving one."
        )
    if model.curve.fixed:
        return
    check_hold(model)


def check_hold(model: LayDownModel) -> None:
    """Raise unless v < I₁(2K/A²)/I₀(2K/A²), K the slope of B far down the belt.

    There the direction has the law of a constant force K, whose mean must be able to
    keep up with the belt. Exact for B = K‖ξ‖; no bound where B grows faster.
    """
    slope = far_slope(model)
    strength = 2.0 * slope / model.noise**2
    largest = float(i1e(strength) / i0e(strength)) if math.isfinite(strength) else 1.0
    if not abs(model.belt_speed) < largest:
        raise ValueError(
            f"`speed` must be below I1(2K/A²)/I0(2K/A²) = {largest:.4g} for a "
            f"potential with the slope K = {slope:g} far out and A = {model.noise:g}, "
            f"got {model.belt_speed:g}; the fibre is otherwise carried away."
        )


def far_slope(model: LayDownModel) -> float:
    """Growth of B per length where the belt would carry the fibre."""
    along, across = (float(one) for one in model.curve.velocity(0.0))
    speed = math.hypot(along, across)
    unit = np.array([-along / speed, -across / speed])
    with np.errstate(over="ignore", invalid="ignore"):
        near, far = (
            float(model.potential.value(*(distance * unit)))
            for distance in (FAR, 2.0 * FAR)
        )
        slope = (far - near) / FAR
    return slope if math.isfinite(slope) else math.inf
