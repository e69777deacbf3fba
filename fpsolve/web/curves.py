"""Single fibres of a web, laid again."""

from __future__ import annotations

from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_integer
from fpsolve.web.margins import LEG
from fpsolve.web.plan import Plan

__all__ = ["curve_of"]


def curve_of(plan: Plan, fibre: Any) -> Array:
    """The corners of a fibre along and across the belt; shape (n_counted + 1, 2).

    Every fibre draws from its own stream: it is the one that was laid with the others.
    """
    plan.ensemble.check_model()
    fibre = check_integer("fibre", fibre, 0, plan.n_fibres - 1)
    motion = plan.motion
    state = plan.ensemble.initial_state(fibre, 1)
    schedule, n_burn = plan.ensemble.schedule, plan.margins.n_burn
    trace = np.empty((LEG, len(state), 1))
    corners = []
    for step in range(0, schedule.n_steps, LEG):
        if step == n_burn:
            first = plan.corners(motion, state, fibre, step) * plan.window.pixel
            corners.append(first.T)
        motion.advance(state, fibre, step, LEG, trace)
        if step >= n_burn:
            corners.append(_corners(plan, trace[:, :, 0], fibre, step))
    return np.concatenate(corners)


def _corners(plan: Plan, trace: Array, fibre: int, step: int) -> Array:
    """After every step of a leg; shape (LEG, 2)."""
    nozzles = plan.nozzles(plan.motion, fibre, 1, step)
    place, *weights = nozzles.places[:, 0]
    moved = nozzles.curve[:, 2:].reshape(-1, 2, 2)
    own = np.einsum("jpi,p->ji", moved, weights)
    ahead = plan.motion.ahead * trace[:, 2:4]
    return np.asarray(trace[:, :2] + nozzles.curve[:, :2] + own + ahead + [0.0, place])
