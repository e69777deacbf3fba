"""From a start to an optimum, by sequential quadratic programming."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import minimize

from fpsolve._support.arrays import Array
from fpsolve.studies.design.goals import Goal, Worst
from fpsolve.studies.design.predictions import Predictions
from fpsolve.studies.design.space import Space

__all__ = ["Found", "searched"]

# Change of the objective, a logarithm, below which it stops; and its steps at most.
PRECISION, MOST_STEPS = 1e-6, 60


@dataclass(frozen=True, eq=False)
class Found:
    """Where a search ended.

    Attributes
    ----------
    y : ndarray
        Logarithms of the free parameters.
    iterates : list of ndarray
        The start and what followed, the end included.
    """

    y: Array
    iterates: list[Array]


def searched(goal: Goal, space: Space, predicted: Predictions, start: Array) -> Found:
    """The point where the goal is best, near a start in the space.

    Its last point need not be one: whoever asks looks at the derivatives there.
    """
    n = start.size
    iterates = [start]
    x = np.append(start, _first(goal, predicted, start))

    def at(x: Array) -> Any:
        return predicted(np.array(x[:n]))

    def asked(of: Callable[..., Any], which: int) -> Callable[[Array], Any]:
        return lambda x: of(x, at(x))[which]

    constraints: list[dict[str, Any]] = []
    if goal.margins(x, at(x))[0].size:
        inside, slopes = asked(goal.margins, 0), asked(goal.margins, 1)
        constraints.append({"type": "ineq", "fun": inside, "jac": slopes})
    if space.row.any():
        constraints.append(_kept(space, n, x.size))
    found = minimize(
        asked(goal.objective, 0), x, jac=asked(goal.objective, 1), method="SLSQP",
        bounds=_ends(space, goal), constraints=constraints,
        callback=lambda x: iterates.append(np.array(x[:n])),
        options={"ftol": PRECISION, "maxiter": MOST_STEPS},
    )  # fmt: skip
    # Rounding of the line search may leave the space by a last digit.
    y = space.nearest(np.array(found.x[:n]))
    last = [] if np.array_equal(y, iterates[-1]) else [y]
    return Found(y, [*iterates, *last])


def _first(goal: Goal, predicted: Predictions, start: Array) -> Array:
    """The bound t to begin with, where the goal has one."""
    if not isinstance(goal, Worst):
        return np.zeros(0)
    return np.array([float(np.log(predicted(start).cv / goal.largest).max())])


def _kept(space: Space, n: int, size: int) -> dict[str, Any]:
    """The base weight as a linear equation."""
    row = np.zeros(size)
    row[:n] = space.row
    kept = float(space.row @ space.origin)
    return {"type": "eq", "fun": lambda x: row @ x - kept, "jac": lambda x: row}


def _ends(space: Space, goal: Goal) -> list[tuple[float, float]]:
    free = (-np.inf, np.inf)
    return [*zip(space.low, space.high, strict=True), *[free] * goal.n_extra]
