"""A part of an ensemble on its way, and what is kept of it."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array
from fpsolve.paths.ensemble import START_BLOCK, Ensemble, angle_of
from fpsolve.paths.histogram import count_paths
from fpsolve.paths.moments import moment_sums, n_sums

__all__ = ["Batch", "BatchRun", "batches_of", "run_batch"]


# Paths worked on at a time; sums over paths are rounded batch by batch, so that it
# must not change either.
BATCH = 16 * START_BLOCK
# Steps between two looks at the state: for progress, interrupts and errors.
LEG = 512


class Batch(NamedTuple):
    """What is left of n paths, for every s that was reached.

    Attributes
    ----------
    first, n : int
    step : int
        Number of the step that was reached.
    states : ndarray, shape (n_saved, n_state, n)
        Or (n_saved, n_state, 0) when they are not kept; likewise `start` and `end`.
    sums : ndarray, shape (n_saved, n_sums)
    counts : ndarray of int64, shape (n_saved, n1, n2, n_alpha)
    outside : ndarray of int64, shape (n_saved,)
    start, end : ndarray, shape (n_state, n)
    n_fast : int
        Paths that end where a step does not resolve how fast the force turns them.
    """

    first: int
    n: int
    step: int
    states: Array
    sums: Array
    counts: NDArray[np.int64]
    outside: NDArray[np.int64]
    start: Array
    end: Array
    n_fast: int


def batches_of(n_paths: int) -> list[tuple[int, int]]:
    """First path and number of paths of every batch."""
    return [(first, min(BATCH, n_paths - first)) for first in range(0, n_paths, BATCH)]


def run_batch(
    ensemble: Ensemble, first: int, n: int, state: Array | None = None
) -> Batch:
    """Paths `first` to `first` + n - 1, from their start or from given states."""
    run = BatchRun(ensemble, first, n, state)
    run.complete()
    return run.result()


class BatchRun:
    """The paths of a batch; what they have reached can be had at any time."""

    def __init__(
        self, ensemble: Ensemble, first: int, n: int, state: Array | None = None
    ) -> None:
        self.ensemble, self.first, self.n = ensemble, first, n
        start = ensemble.initial_state(first, n) if state is None else state
        self.start, self.state = start, start.copy()
        self.step = ensemble.first_step
        self.states: list[Array] = []
        self.sums: list[Array] = []
        self.counts: list[NDArray[np.int64]] = []
        self.outside: list[int] = []

    def complete(self, report: Callable[[int, float], None] | None = None) -> None:
        """Run to the end; `report` is told path-steps and s after every leg."""
        schedule = self.ensemble.schedule
        for stop in sorted({*schedule.saves, schedule.n_steps}):
            while self.step < stop:
                n_steps = min(LEG, stop - self.step)
                self.ensemble.integrator.advance(
                    self.state, self.first, self.step, n_steps
                )
                self.step += n_steps
                if report is not None:
                    report(n_steps * self.n, schedule.s(self.step))
            if stop in schedule.saves:
                self._keep()

    def _keep(self) -> None:
        self.sums.append(moment_sums(self.state))
        if self.ensemble.keep:
            self.states.append(self.state.copy())
        if self.ensemble.grid is not None:
            xi1, xi2 = self.state[:2]
            alpha = angle_of(self.state)
            counts, outside = count_paths(self.ensemble.grid, xi1, xi2, alpha)
            self.counts.append(counts)
            self.outside.append(outside)

    def result(self) -> Batch:
        """What has been kept until now."""
        grid, keep = self.ensemble.grid, self.ensemble.keep
        shape = (len(self.counts), *((0, 0, 0) if grid is None else grid.shape))
        n_kept, n_state = self.n if keep else 0, len(self.state)
        return Batch(
            first=self.first,
            n=self.n,
            step=self.step,
            states=np.array(self.states).reshape(len(self.sums), n_state, n_kept),
            sums=np.array(self.sums).reshape(-1, n_sums(n_state)),
            counts=np.array(self.counts, dtype=np.int64).reshape(shape),
            outside=np.array(self.outside, dtype=np.int64),
            # Copies: a view of nothing would keep the whole array alive.
            start=self.start[:, :n_kept].copy(),
            end=self.state[:, :n_kept].copy(),
            n_fast=self.ensemble.integrator.n_fast(self.state),
        )
