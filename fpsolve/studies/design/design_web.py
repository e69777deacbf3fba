"""The process that lays the most even web, or an even enough one at the least cost."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.evolution.call import recorded
from fpsolve.model.process import Process
from fpsolve.studies.design.confirm import laid_variation
from fpsolve.studies.design.front import front_of
from fpsolve.studies.design.optimality import Optimality, optimality
from fpsolve.studies.design.predictions import Predictions
from fpsolve.studies.design.result import WebDesign
from fpsolve.studies.design.search import Found
from fpsolve.studies.design.settings import PARAMETERS
from fpsolve.studies.design.solving import check_optimum, goal_of, optimum
from fpsolve.studies.design.target import COSTS, pairs_of
from fpsolve.studies.design.task import Task, task_of

__all__ = ["design_web"]


@recorded(target=lambda target, _: pairs_of(target))
def design_web(
    process: Process,
    target: Any,
    *,
    spacing: float,
    titer: float,
    free: Iterable[str],
    bounds: Mapping[str, tuple[float, float]] | None = None,
    positions: str = "regular",
    cost: str = "throughput",
    tolerance: float = 2e-2,
    front: int = 0,
    n_webs: int = 12,
    seed: int = 1,
) -> WebDesign:
    """min Σ log CV(x_i), or max θ with CV(x_i) <= c_i, at fixed titer/(v d).

    Sequential quadratic programming in the logarithms of the parameters, on the CV and
    the slopes of `predict_web`. The base weight, that of the start, is kept exactly: of
    belt speed v, spacing d and titer two or three are free, or none. The optimum is
    one among its neighbours; other starts may find another. It is laid, and the
    variation of that web is measured.

    Parameters
    ----------
    process : Process
        Where the search begins, or the nearest point within the bounds. With a
        `relaxation_length` fibres are smooth, and predictions take long.
    target : float, sequence of float, or mapping of float to float
        Sides of square zones in metres, whose mean of log CV is minimised; or with the
        largest CV of each (also as pairs), where `cost` is minimised.
    spacing : float
        Distance d of the spinning positions in metres.
    titer : float
        Mass of the fibre in g/m, 1 dtex is 1e-4.
    free : iterable of str
        Among "noise", "sigma1", "sigma2", "speed_ratio", "spacing", "titer" and, of
        smooth fibres, "relaxation_length".
    bounds : mapping of str to (float, float), optional
        Lowest and highest value of free parameters; by default the industrial ranges
        of `Process`, none for the spacing, and no default for the titer.
    positions : {"regular", "random"}
    cost : {"throughput", "positions", "fineness"}
        What is bought with unevenness where CV is bounded: the highest belt speed, and
        with it throughput; the largest spacing, and with it the fewest spinning
        positions; the largest titer.
    tolerance : float
        For every predicted CV, relative; most errors are a tenth of it.
    front : int
        Throughputs, evenly between the slowest belt and the fastest, at which the most
        even web is searched too; 0 or at least 2.
    n_webs : int
        Webs that are laid of the optimum for every zone, 0 or at least 2.
    seed : int
        Of these webs.

    Returns
    -------
    WebDesign

    Raises
    ------
    ValueError, TypeError
        Bad arguments, as `predict_web`; one alone of v, d and titer is free; no point
        within the bounds has the base weight.
    UnreachableTargetError
        If no process within the bounds is found that meets the bounds of CV; it says
        how far they are met.
    ToleranceError
        If a web cannot be predicted to the tolerance, or the search ends where bounds
        do not balance the gradient.

    References
    ----------
    [KMW09]_, section 4.2.
    """
    task = task_of(
        process, target, spacing=spacing, titer=titer, free=free, bounds=bounds,
        positions=positions, cost=cost, tolerance=tolerance, front=front,
        n_webs=n_webs, seed=seed,
    )  # fmt: skip
    aim, space = task.target, task.space
    predicted = Predictions(space, aim.zones, task.positions, task.tolerance)
    goal = goal_of(aim, space, COSTS[task.cost])
    found = optimum(goal, aim, predicted)
    tested = optimality(goal, space, predicted, found.y)
    check_optimum(tested, predicted, found.y)
    points = []
    if task.front:
        points = front_of(aim, space, predicted, found.y, task.front)
    return design_of(task, predicted, found, tested, points, laid(task, found.y))


def laid(task: Task, y: Array) -> Array:
    """CV of laid webs at an optimum and its standard errors, by zone; NaN without."""
    zones = task.target.zones
    if not task.n_webs:
        return np.full((2, zones.size), np.nan)
    return np.array(
        laid_variation(
            task.space.settings(y), zones, task.positions, task.n_webs, task.seed
        )
    )


def design_of(
    task: Task,
    predicted: Predictions,
    found: Found,
    tested: Optimality,
    points: list[Array],
    simulated: Array,
) -> WebDesign:
    """The result, over all parameters; NaN or 0 of those that are not free."""
    aim, space, at = task.target, task.space, predicted(found.y)
    settings = space.settings(found.y)

    def over_all(numbers: Array, otherwise: float) -> Array:
        placed = np.full(len(PARAMETERS), otherwise)
        placed[space.places] = numbers
        return placed

    iterates, of_front = [
        np.array([space.settings(y).values for y in some]).reshape(-1, len(PARAMETERS))
        for some in (found.iterates, points)
    ]
    along = [predicted(y) for y in points]
    of_zones = (-1, aim.zones.size)
    of_targets = tested.targets if aim.bounded else np.zeros(aim.zones.size)
    return WebDesign(
        settings.process, settings.spacing, settings.titer, task.positions,
        task.cost,
        over_all(tested.errors, 0.0),
        over_all(np.exp(space.low), np.nan), over_all(np.exp(space.high), np.nan),
        over_all(tested.lower, 0.0), over_all(tested.upper, 0.0),
        aim.zones, aim.largest, of_targets,
        at.cv, at.errors, at.slopes, at.slope_errors, tested.residual,
        iterates, np.array([predicted(y).cv for y in found.iterates]), predicted.n,
        simulated[0], simulated[1], task.n_webs,
        of_front, np.array([one.cv for one in along]).reshape(of_zones),
        np.array([one.errors for one in along]).reshape(of_zones),
    )  # fmt: skip
