"""The optimum of a target: found, within its bounds, and tested."""

from __future__ import annotations

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.errors import ToleranceError, UnreachableTargetError
from fpsolve.studies.design.goals import Cheapest, Evenest, Goal, Worst
from fpsolve.studies.design.optimality import AT_TARGET, Optimality
from fpsolve.studies.design.predictions import Predictions
from fpsolve.studies.design.search import Found, searched
from fpsolve.studies.design.space import Space
from fpsolve.studies.design.target import Target

__all__ = ["check_optimum", "goal_of", "optimum"]

# Gradient per logarithm of a parameter that may be left where slopes are exact.
RESIDUAL = 5e-3


def goal_of(aim: Target, space: Space, name: str) -> Goal:
    """What a target minimises: CV, or what its bounds cost."""
    if aim.bounded:
        return Cheapest(space, aim.largest, name)
    return Evenest(space, aim.zones.size)


def optimum(goal: Goal, aim: Target, predicted: Predictions) -> Found:
    """Where a search from the start ends, within the bounds of CV if there are any.

    Raises
    ------
    UnreachableTargetError
        If these bounds are not met.
    """
    space = predicted.space
    found = searched(goal, space, predicted, space.nearest(space.origin))
    if not aim.bounded or excess(aim, predicted, found.y) <= AT_TARGET:
        return found
    # The way into the bounds is searched by itself.
    within = searched(Worst(space, aim.largest), space, predicted, found.y)
    if excess(aim, predicted, within.y) > AT_TARGET:
        raise unreachable(aim, predicted, within.y)
    last = searched(goal, space, predicted, within.y)
    if excess(aim, predicted, last.y) > AT_TARGET:
        raise unreachable(aim, predicted, last.y)
    return Found(last.y, [*found.iterates, *within.iterates, *last.iterates])


def excess(aim: Target, predicted: Predictions, y: Array) -> float:
    """The largest of log (CV/bound) over the zones."""
    return float(np.log(predicted(y).cv / aim.largest).max())


def unreachable(
    aim: Target, predicted: Predictions, y: Array
) -> UnreachableTargetError:
    """The error that says how near to a target was come, and where."""
    at = predicted(y)
    worst = int(np.argmax(at.cv / aim.largest))
    values = np.exp(y).tolist()
    place = dict(zip(predicted.space.names, values, strict=True))
    return UnreachableTargetError(
        float(aim.zones[worst]), float(aim.largest[worst]), float(at.cv[worst]),
        float(at.errors[worst]), place,
    )  # fmt: skip


def check_optimum(tested: Optimality, predicted: Predictions, y: Array) -> None:
    """Raise ToleranceError unless bounds balance the gradient up to its errors."""
    of_slopes = predicted(y).slope_errors[predicted.space.places]
    allowed = RESIDUAL + float(of_slopes.max())
    if not tested.residual <= allowed:
        raise ToleranceError(
            tested.residual, allowed,
            "the search ended where no bound balances the gradient: lower `tolerance`, "
            "or begin elsewhere",
        )  # fmt: skip
