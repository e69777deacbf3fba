"""The trade-off: how even a web can be at every throughput."""

from __future__ import annotations

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.studies.design.goals import Evenest, Goal, Worst
from fpsolve.studies.design.predictions import Predictions
from fpsolve.studies.design.search import searched
from fpsolve.studies.design.space import Space
from fpsolve.studies.design.target import Target

__all__ = ["SPEED", "front_of"]

# At a fixed base weight the throughput goes with the belt speed.
SPEED = "speed_ratio"


def front_of(
    target: Target, space: Space, predicted: Predictions, y: Array, n: int
) -> list[Array]:
    """The best points of the space at n belt speeds, from the slowest to the fastest.

    Each search begins at the optimum beside it, those of the optimum y first.
    """
    low, high = space.reach(SPEED)
    place = space.names.index(SPEED)
    speeds = np.linspace(low, high, n)
    middle = int(np.argmin(np.abs(speeds - y[place])))
    found: dict[int, Array] = {}
    for order in (range(middle, n), range(middle - 1, -1, -1)):
        near = y
        for k in order:
            near = found[k] = best_at(target, space, predicted, near, float(speeds[k]))
            if k == middle:
                y = near
    return [found[k] for k in range(n)]


def best_at(
    target: Target, space: Space, predicted: Predictions, near: Array, speed: float
) -> Array:
    """The best point at one belt speed."""
    held = space.pinned(SPEED, speed)
    start = held.nearest(near)
    if not (free := held.high > held.low).any() or free.sum() == held.row[free].any():
        # The base weight leaves one point.
        return start
    goal: Goal = Evenest(held, target.zones.size)
    if target.bounded:
        goal = Worst(held, target.largest)
    return searched(goal, held, predicted, start).y
