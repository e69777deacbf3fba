"""A web laid stretch by stretch: in memory is what lies below the nozzles, no more.

The belt carries the web away from the nozzles. Fibres are laid over as many steps as
the belt takes for a stretch, on an image as long as they reach; what is laid is given
away, and the fibres go on from where they are.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from fpsolve._kernels import raster as kernels
from fpsolve._support.arrays import Array
from fpsolve.web.laying import Counts, Laid, Laying, check_client, groups_of, touched
from fpsolve.web.margins import LEG
from fpsolve.web.plan import Plan

__all__ = ["lay_in_stretches", "lay_stretch"]

Report = Callable[[int, float], None]


class Carried(NamedTuple):
    """Fibres between two stretches: their states and their last corners."""

    state: Array
    corners: Array


class Stretch(Laying):
    """Some fibres on their way, whose image reaches as far as they do.

    No piece of a fibre is longer than a step, whatever its nozzle does: over a leg its
    corners go no further than the leg is long.
    """

    def __init__(self, plan: Plan, first: int, n: int, carried: Carried | None) -> None:
        n_rows = plan.window.shape[0]
        super().__init__(
            plan, first, n, np.zeros((1, n_rows, 0, kernels.N_COUNTED), np.int64)
        )
        if carried is not None:
            self.state, self.corners = (np.array(one) for one in carried)

    def take(self, steps: tuple[int, int], report: Report | None = None) -> None:
        """Take the steps of the stretch."""
        schedule = self.plan.ensemble.schedule
        for step in range(*steps, LEG):
            self.take_leg(step)
            if report is not None:
                report(LEG * self.n, schedule.s(step + LEG))

    def _lay(self, trace: Array, first: int, some: slice, step: int) -> None:
        self._make_room(self.corners[0, some])
        super()._lay(trace, first, some, step)

    def _make_room(self, along: Array) -> None:
        """Lengthen the image where fibres from these corners may come in a leg."""
        plan, n_columns = self.plan, self.plan.window.shape[1]
        # And a pixel for rounding.
        farthest = LEG * plan.ensemble.schedule.ds / plan.window.pixel + 1.0
        low = min(max(math.floor(along.min() - farthest), 0), n_columns)
        high = min(max(math.ceil(along.max() + farthest), 0), n_columns)
        first, width = self.raster.first_column, self.images.shape[2]
        if low >= high or (first <= low and high <= first + width):
            return
        if width:
            low, high = min(low, first), max(high, first + width)
        image: Counts = np.zeros((1, self.images.shape[1], high - low,
                                  kernels.N_COUNTED), np.int64)  # fmt: skip
        image[:, :, first - low : first - low + width] = self.images
        self.images, self.raster = image, self.raster._replace(first_column=low)


def lay_stretch(
    plan: Plan,
    first: int,
    n: int,
    steps: tuple[int, int],
    carried: Carried | None,
    report: Report | None = None,
) -> tuple[Laid, Carried]:
    """Lay some fibres over some steps, from where they are or from their start."""
    stretch = Stretch(plan, first, n, carried)
    stretch.take(steps, report)
    return touched(stretch.result()), Carried(stretch.state, stretch.corners)


def lay_in_stretches(
    plan: Plan, length: float, client: Any, report: Report
) -> Iterator[Laid]:
    """Lay all fibres, a stretch of the belt after the other.

    Parameters
    ----------
    plan : Plan
    length : float
        Of a stretch, in units of the throwing range.
    client : optional
        Where to lay, group by group of the fibres; here by default, all at once.
    report : callable
        Told the steps that are done, and s.
    """
    if client is not None:
        check_client(client)
    whole = [(0, plan.n_fibres)] if plan.n_fibres else []
    groups = whole if client is None else groups_of(plan.n_fibres)
    carried: list[Carried | None] = [None] * len(groups)
    found: Iterator[tuple[Laid, Carried]]
    for steps in stretches(plan, length):
        if client is None:
            found = (
                lay_stretch(plan, *group, steps, fibres, report)
                for group, fibres in zip(groups, carried, strict=True)
            )
        else:
            found = _elsewhere(plan, client, groups, steps, carried)
        for k, (laid, fibres) in enumerate(found):
            carried[k] = fibres
            yield laid
            if client is not None:
                taken = (steps[1] - steps[0]) * groups[k][1]
                report(taken, plan.ensemble.schedule.s(steps[1]))


def stretches(plan: Plan, length: float) -> Iterator[tuple[int, int]]:
    """First step of every stretch, and the one after its last; with it the burn-in."""
    schedule, start = plan.ensemble.schedule, 0
    along = abs(plan.speed) * schedule.ds * LEG
    taken = LEG * max(math.ceil(length / along), 1)
    end = plan.margins.n_burn + taken
    while start < schedule.n_steps:
        yield start, min(end, schedule.n_steps)
        start, end = end, end + taken


def _elsewhere(
    plan: Plan,
    client: Any,
    groups: list[tuple[int, int]],
    steps: tuple[int, int],
    carried: list[Carried | None],
) -> Iterator[tuple[Laid, Carried]]:
    """What the client lays of one stretch, in the order of the groups."""
    futures = deque(
        client.submit(lay_stretch, plan, first, n, steps, fibres)
        for (first, n), fibres in zip(groups, carried, strict=True)
    )
    while futures:
        # One at a time, so that nothing refers to what was taken.
        yield futures.popleft().result()
