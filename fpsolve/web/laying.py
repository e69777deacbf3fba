"""Fibres laid on the raster: here, or some of them elsewhere, and summed up."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any, NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from fpsolve._kernels import raster as kernels
from fpsolve._kernels.paths import LANES
from fpsolve._kernels.threads import CELLS_PER_THREAD, threads_worth_their_wait
from fpsolve._support.arrays import Array
from fpsolve.web.margins import LEG
from fpsolve.web.plan import Plan

__all__ = [
    "PIXEL_BYTES",
    "Counts",
    "Laid",
    "Laying",
    "check_client",
    "groups_of",
    "image_shape",
    "lay_elsewhere",
    "lay_here",
    "lay_on",
    "n_workers_for",
    "total",
    "touched",
]

Counts = NDArray[np.int64]
# Fibres whose steps are kept at once for every thread: few enough for its cache, and
# enough for threads not to wait for one another.
_PER_WORKER = 16 * LANES
# Steps of a leg for which a second thread is worth its wait.
_STEPS_PER_THREAD = 2**15
# Fibres of one piece of work elsewhere.
_ELSEWHERE = 16 * LANES
# Bytes of a pixel: what is counted, as integers.
PIXEL_BYTES = 8 * kernels.N_COUNTED


class Laid(NamedTuple):
    """What fibres have left.

    Attributes
    ----------
    counts : ndarray of int64, shape (n_rows, n_columns, 3)
        From row `row` on.
    row : int
    outside : int
        Counts outside of the window; a Python integer, which has no end.
    beyond : int
        Pieces that lie beyond the reach for which there are margins.
    column : int
        Their first one.
    """

    counts: Counts
    row: int
    outside: int
    beyond: int
    column: int = 0


class Laying:
    """Some fibres of a web on their way.

    Parameters
    ----------
    plan : Plan
    first, n : int
        Which fibres.
    images : ndarray of int64, shape (n_workers, n_rows, n_columns, 3)
        Zeros; each is filled by one thread.
    """

    def __init__(self, plan: Plan, first: int, n: int, images: Counts) -> None:
        self.plan, self.first, self.n = plan, first, n
        self.motion, self.raster = plan.motion, plan.raster()
        self.state = plan.ensemble.initial_state(first, n)
        self.corners = np.empty((2, n))
        n_workers, self.images = len(images), images
        self.tallies: Counts = np.zeros((n_workers, kernels.N_TALLIES), np.int64)
        self.group = _PER_WORKER * n_workers
        n_traced = min(self.group, n)
        self.trace = np.empty((LEG, self.motion.integrator.n_state, n_traced))

    def complete(self, report: Callable[[int, float], None] | None = None) -> None:
        """Take all steps; `report` is told the steps and s after every leg."""
        schedule = self.plan.ensemble.schedule
        with threads_worth_their_wait(len(self.images) * CELLS_PER_THREAD):
            for step in range(0, schedule.n_steps, LEG):
                self.take_leg(step)
                if report is not None:
                    report(LEG * self.n, schedule.s(step + LEG))

    def take_leg(self, step: int) -> None:
        """All fibres over the same steps."""
        n_burn = self.plan.margins.n_burn
        if step == n_burn:
            self.corners = self.plan.corners(self.motion, self.state, self.first, step)
        for start in range(0, self.n, self.group):
            some = slice(start, min(start + self.group, self.n))
            # Kernels work on whole arrays.
            state = np.ascontiguousarray(self.state[:, some])
            first, n = self.first + start, state.shape[1]
            if step < n_burn:
                self.motion.advance(state, first, step, LEG, None)
            else:
                trace = self.trace if n == self.trace.shape[2] else self._trace_of(n)
                self.motion.advance(state, first, step, LEG, trace)
                self._lay(trace, first, some, step)
            self.state[:, some] = state

    def result(self) -> Laid:
        """What all workers have laid."""
        counts = self.images[0]
        for image in self.images[1:]:
            counts += image
        units, rest, beyond = self.tallies.sum(axis=0).tolist()
        outside = units * kernels.UNIT + rest
        return Laid(counts, 0, outside, beyond, self.raster.first_column)

    def _trace_of(self, n: int) -> Array:
        return np.empty((*self.trace.shape[:2], n))

    def _lay(self, trace: Array, first: int, some: slice, step: int) -> None:
        nozzles = self.plan.nozzles(self.motion, first, trace.shape[2], step)
        corners = np.ascontiguousarray(self.corners[:, some])
        kernels.lay_fibres(
            trace, nozzles, self.raster, corners, self.tallies, self.images
        )
        self.corners[:, some] = corners


def n_workers_for(n_fibres: int, bytes_of_image: int, bytes_left: float) -> int:
    """Images that are filled at once: one for every thread that has work and memory.

    What is laid does not depend on it.
    """
    busy = n_fibres * LEG // _STEPS_PER_THREAD
    room = int(bytes_left // bytes_of_image)
    return max(1, min(numba.get_num_threads(), busy, room))


def lay_here(
    plan: Plan, n_workers: int, report: Callable[[int, float], None] | None = None
) -> Laid:
    """Lay all fibres with the threads of this process."""
    images = np.zeros((n_workers, *image_shape(plan)), np.int64)
    return lay_on(plan, images, report)


def lay_on(
    plan: Plan, images: Counts, report: Callable[[int, float], None] | None = None
) -> Laid:
    """Lay all fibres on images that are there, with a thread for each of them."""
    laying = Laying(plan, 0, plan.n_fibres, images)
    laying.complete(report)
    return laying.result()


def image_shape(plan: Plan) -> tuple[int, ...]:
    """Shape of the counts of a web."""
    return (*plan.window.shape, kernels.N_COUNTED)


def lay_some(plan: Plan, first: int, n: int) -> Laid:
    """Lay some fibres, and return the rows of the image that they touch."""
    images = np.zeros((1, *image_shape(plan)), np.int64)
    laying = Laying(plan, first, n, images)
    laying.complete()
    return touched(laying.result())


def touched(laid: Laid) -> Laid:
    """With those rows alone in which something lies."""
    rows = np.flatnonzero(laid.counts[:, :, 0].any(axis=1))
    low, high = (0, 0) if not rows.size else (int(rows[0]), int(rows[-1]) + 1)
    return laid._replace(counts=laid.counts[low:high].copy(), row=low)


def lay_elsewhere(
    plan: Plan, client: Any, report: Callable[[int, float], None]
) -> Laid:
    """Lay all fibres on a client, group by group; sums of integers have no order."""
    check_client(client)
    futures = deque(
        (n, client.submit(lay_some, plan, first, n))
        for first, n in groups_of(plan.n_fibres)
    )
    counts = np.zeros(image_shape(plan), np.int64)
    outside, beyond, schedule = 0, 0, plan.ensemble.schedule
    while futures:
        n, future = futures.popleft()
        part = future.result()
        counts[part.row : part.row + len(part.counts)] += part.counts
        outside, beyond = outside + part.outside, beyond + part.beyond
        report(n * schedule.n_steps, schedule.end)
    return Laid(counts, 0, outside, beyond)


def check_client(client: Any) -> None:
    """Raise TypeError unless it takes work."""
    if not hasattr(client, "submit"):
        raise TypeError(
            f"`client` must have a method submit(f, *args), got {client!r}; pass a "
            "dask.distributed client or an executor."
        )


def groups_of(n_fibres: int) -> list[tuple[int, int]]:
    """First fibre and number of fibres of every group that is laid elsewhere."""
    return [
        (first, min(_ELSEWHERE, n_fibres - first))
        for first in range(0, n_fibres, _ELSEWHERE)
    ]


def total(counts: Counts) -> int:
    """The sum of counts of length, exactly, however large it is."""
    # Row by row: the counts may lie on a disk, and not fit into memory.
    return sum(
        int((row >> kernels.UNIT_BITS).sum()) * kernels.UNIT
        + int((row & (kernels.UNIT - 1)).sum())
        for row in counts[..., 0]
    )
