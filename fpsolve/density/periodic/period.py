"""The period of a reference curve, the belt that moves like it on average, steps."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from fpsolve.density.stationary.requirements import check_stationary
from fpsolve.density.stationary.strides import STRIDE
from fpsolve.model.curves.belts import MovingBelt
from fpsolve.model.curves.curve import Curve
from fpsolve.model.fibre import FibreModel

__all__ = ["check_periodic", "on_mean_belt", "period_of", "steps_and_length"]

# Places of a period at which γ is asked, and how far from periodic counts as rounding.
ASKED, ROUNDING = 16, 1e-9
# Steps of a period at least: of fewer nothing would be seen of its motion.
FEWEST_STEPS = 6


def period_of(curve: Curve) -> float:
    """P with γ(s + P) = γ(s) − v P e₁ for every s.

    Raises
    ------
    ValueError
        If the curve names no period, or does not repeat itself after it.
    """
    period = float(getattr(curve, "period", math.nan))
    if not 0 < period < math.inf:
        raise ValueError(
            f"`curve` must move periodically, got {curve!r}; take a rotating or "
            "oscillating nozzle or a curve with a `period`, and `steady_state` for "
            "one that moves at constant speed."
        )
    asked = np.arange(ASKED) * (period / ASKED)
    moved = np.array([curve.displacement(s, s + period) for s in asked])
    apart = float(np.abs(moved - (-curve.speed * period, 0.0)).max())
    size = max(period, *(np.abs(one).max() for one in curve.position(asked)))
    if not apart <= ROUNDING * size:
        raise ValueError(
            f"`curve` must move by -v P e1 over its period P = {period:g}, got "
            f"{curve!r}, which differs from that by {apart:.2g}; correct `period`, or "
            "`speed`."
        )
    return period


def on_mean_belt(model: Any) -> Any:
    """The same model on a belt that moves as the curve does on average."""
    return replace(model, curve=MovingBelt(model.curve.speed))


def check_periodic(model: FibreModel) -> float:
    """The period; ValueError if the model has no periodic density, or many.

    Far out the periodic part of γ does not count, so that the fibre is held where it
    is on the mean belt.
    """
    period = period_of(model.curve)
    check_stationary(on_mean_belt(model))
    return period


def steps_and_length(period: float, ds: float) -> tuple[float, float]:
    """The longest step up to ds that divides a period, and whole periods of a unit."""
    step = period / max(FEWEST_STEPS, math.ceil(period / ds))
    return step, period * max(1, round(STRIDE / period))
