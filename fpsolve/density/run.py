"""One pass of a run: the loop, its checks and its records."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.progress import ProgressCallback
from fpsolve._support.provenance import Stopwatch
from fpsolve.density.keeper import MemoryKeeper, Snapshot, fields_of
from fpsolve.density.recorder import Recorder
from fpsolve.density.schemes.dictionaries import describe_scheme
from fpsolve.density.schemes.scheme import Scheme
from fpsolve.density.solution import Solution
from fpsolve.density.tolerances import Tolerances, check_finite, check_record
from fpsolve.errors import RunError, RunInterrupted
from fpsolve.evolution.call import Call
from fpsolve.evolution.schedule import Schedule

if TYPE_CHECKING:
    from fpsolve.density.checkpoints.keeper import CheckpointKeeper

__all__ = ["Run"]


class Run:
    """One pass over a schedule, from its start or its last checkpoint to the end.

    Attributes
    ----------
    step : int
        Steps done at the last record.
    settled : bool
        Whether the state is that of the last record: between two it is not.
    """

    def __init__(
        self,
        scheme: Scheme,
        p0: Array,
        reference: Array | None,
        recorder: Recorder,
        tolerances: Tolerances,
        call: Call,
        schedule: Schedule,
        keeper: MemoryKeeper | CheckpointKeeper,
    ) -> None:
        self.scheme, self.schedule, self.keeper = scheme, schedule, keeper
        self.tolerances, self.saves = tolerances, frozenset(schedule.saves)
        self.p0, self.reference, self.call = p0, reference, call
        self.recorder = recorder.fresh()
        self.state = scheme.start(p0)
        self.step, self.settled = 0, False
        self.watch = Stopwatch()

    def complete(
        self,
        report: ProgressCallback,
        n_before: int,
        n_total: int,
        done: Sequence[Solution] = (),
    ) -> Solution:
        """Run to the end; what stops it leaves with the partial solution.

        With extrapolation the runs at ds, ds/2, … are `done`: the last of them is what
        is left when the next stops.
        """
        try:
            self._begin()
            report(n_before + self.step, n_total, self.schedule.s(self.step))
            for first, last in self._legs():
                self._advance(first, last)
                report(n_before + last, n_total, self.schedule.s(last))
                self.keeper.after(last, self.snapshot)
            self.keeper.finish(self.step, self.snapshot)
        except RunError as error:
            error.solution = self._partial("failed", str(error), done)
            raise
        except KeyboardInterrupt:
            step = self.step if self.settled else None
            message = (
                f"stopped by the user{self.keeper.interrupted(step, self.snapshot)}"
            )
            partial = self._partial("interrupted", message, done)
            raise RunInterrupted(partial) from None
        return self._solution("finished", "", done)

    def snapshot(self, n_saved: int) -> Snapshot:
        """Return what is needed to go on from here, with so many densities saved."""
        return Snapshot(
            step=self.step,
            s=self.schedule.s(self.step),
            n_saved=n_saved,
            seconds=self.watch.seconds(),
            columns=self.recorder.columns,
            records=self.recorder.table(),
            state=fields_of(self.state),
        )

    def _begin(self) -> None:
        """Record the start, or go to where the run was left."""
        left = self.keeper.last()
        if left is None:
            self._record(0)
        else:
            for name, value in left.state.items():
                setattr(self.state, name, value)
            self.recorder.go_on(left.columns, left.records)
            self.watch.add(*left.seconds)
            self.step = left.step
        self.settled = True

    def _legs(self) -> Iterator[tuple[int, int]]:
        """The legs that are left."""
        reached = self.step
        return (leg for leg in self.schedule.legs() if leg[0] >= reached)

    def _advance(self, first: int, last: int) -> None:
        self.settled = False
        s = self.schedule.s(first)
        self.scheme.advance(self.state, s, self.schedule.ds, last - first)
        self._record(last)
        self.step, self.settled = last, True

    def _record(self, step: int) -> None:
        s = self.schedule.s(step)
        p = self.scheme.density(self.state)
        told = {"mass_correction": self.state.correction, **self.state.report}
        check_finite(p, s)
        record = self.recorder.record if step else self.recorder.record_start
        values = record(p, s, told)
        if step in self.saves:
            self.keeper.save(p)
        mass = self.recorder.first["mass"]
        check_record(values, mass, self.scheme, self.state, self.tolerances)

    def _partial(self, status: str, message: str, done: Sequence[Solution]) -> Solution:
        if not done:
            return self._solution(status, message)
        n = len(done)
        kept = f"ds/{n}" if n > 1 else "ds"
        message += (
            f" (in the run at ds/{n + 1}: this is the one at {kept}, not extrapolated)"
        )
        return replace(done[-1], status=status, message=message)

    def _solution(
        self, status: str, message: str, done: Sequence[Solution] = ()
    ) -> Solution:
        recorder, saves = self.recorder, self.schedule.saves[: self.keeper.n_saved]
        return Solution(
            model=self.scheme.model,
            grid=self.scheme.grid,
            scheme=done[-1].scheme if done else describe_scheme(self.scheme),
            ds=self.schedule.ds,
            series=recorder.series(),
            saved_s=np.array([self.schedule.s(step) for step in saves]),
            densities=self.keeper.densities(),
            entropy_floor=recorder.floor(),
            status=status,
            message=message,
            provenance=self._provenance(done),
            initial_density=self._kept_start(),
            reference=self.reference,
            call=self.call,
        )

    def _provenance(self, done: Sequence[Solution]) -> dict[str, Any]:
        """What made the result; of a scheme on a device, which one."""
        # All passes of a run have their threads in common, and all else of it.
        known = done[-1].provenance["environment"] if done else None
        found = self.watch.provenance(self.state.n_steps, known)
        origin = getattr(self.scheme, "origin", None)
        return found if origin is None else {**found, "arrays": origin}

    def _kept_start(self) -> Array:
        """p0, which the caller's array may not be for long."""
        # No step follows, so that the scratch array is free: a copy costs no memory.
        if self.state.work.shape != self.p0.shape:
            return self.p0.copy()
        self.state.work[...] = self.p0
        return self.state.work
