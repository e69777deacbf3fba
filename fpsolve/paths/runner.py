"""Batches of paths, run here or elsewhere, and gathered to one result."""

from __future__ import annotations

import math
import sys
import warnings
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from typing import Any, TypeAlias

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_real
from fpsolve._support.memory import OVERHEAD, check_memory
from fpsolve._support.progress import ProgressCallback, reporting
from fpsolve._support.provenance import Stopwatch, announced_compilation
from fpsolve.errors import NonFinitePathError, RunInterrupted
from fpsolve.evolution.call import Call
from fpsolve.evolution.schedule import Schedule, make_schedule
from fpsolve.model.identity.digests import digest_or_none
from fpsolve.paths.batch import Batch, BatchRun, batches_of, run_batch
from fpsolve.paths.call import call_of
from fpsolve.paths.ensemble import Ensemble, GivenStart

__all__ = ["completed", "going_on", "required_memory", "stepwise"]

# What makes a result of an ensemble, its batches and their provenance.
Gather: TypeAlias = Callable[[Ensemble, list[Batch], dict[str, Any]], Any]
NOTHING = np.zeros(0, dtype=np.int64)
CLOCKS = ("wall", "cpu")
# Paths that may end where a step is too long for the force.
LARGEST_SHARE = 0.01


def completed(
    make: Callable[..., Any],
    ensemble: Ensemble,
    before: Any,
    client: Any,
    progress: Any,
) -> Any:
    """Run all batches, here or on a client, and gather them.

    Paths that go on from others become one with them: they begin where those began.

    Parameters
    ----------
    make : callable
        What makes a result of the arrays: the class `Paths`.
    ensemble : Ensemble
    before : Paths or None
        Those that go on.
    client, progress
        As for `sample_paths`.
    """
    watch, gather = Stopwatch(), partial(gathered, make, before, call_of(ensemble))
    states = None
    if before is not None:
        states = before.end
        spent = (before.provenance.get(f"{kind}_seconds", 0.0) for kind in CLOCKS)
        watch.add(*spent)
    n_steps = ensemble.schedule.n_steps - ensemble.first_step
    n_total = ensemble.n_paths * n_steps
    with reporting(progress) as report, announced_compilation(bool(progress)):
        meter = Meter(report, n_total, ensemble.schedule)
        batches: list[Batch] = []
        with keeping_what_is_done(gather, ensemble, batches, watch):
            if client is None:
                run_here(ensemble, states, meter, batches)
            else:
                run_elsewhere(ensemble, states, meter, batches, client)
    warn_of_long_steps(ensemble, batches)
    n_total = ensemble.n_paths * ensemble.schedule.n_steps
    return gather(ensemble, batches, watch.provenance(n_total))


def warn_of_long_steps(ensemble: Ensemble, batches: list[Batch]) -> None:
    """Warn if the step does not resolve the force where more than a few paths end."""
    n_fast = sum(batch.n_fast for batch in batches)
    allowed = LARGEST_SHARE * ensemble.n_paths
    # Three standard deviations: a few paths are no share of all.
    if n_fast > allowed + 3.0 * math.sqrt(allowed):
        share = n_fast / ensemble.n_paths
        longest = ensemble.integrator.largest_turn
        warnings.warn(
            f"`ds` = {ensemble.schedule.ds:g} is long for this force: |∇B| ds exceeds "
            f"{longest:g} where {100 * share:.2g} % of the paths end, and averages may "
            "be off by as much; compare with a shorter step",
            UserWarning,
            stacklevel=4,
        )


class Meter:
    """Path-steps done, told to whoever wants to know."""

    def __init__(
        self, report: ProgressCallback, n_total: int, schedule: Schedule
    ) -> None:
        self.report, self.n_total, self.n_done = report, n_total, 0
        self.s_end = schedule.s(schedule.n_steps)

    def __call__(self, n_path_steps: int, s: float | None = None) -> None:
        """Count on, and report."""
        self.n_done += n_path_steps
        self.report(self.n_done, self.n_total, self.s_end if s is None else s)


def run_here(
    ensemble: Ensemble, states: Array | None, meter: Meter, batches: list[Batch]
) -> None:
    """One batch after the other; an interrupt leaves what the first one reached."""
    for first, n in batches_of(ensemble.n_paths):
        run = BatchRun(ensemble, first, n, part(states, first, n))
        try:
            run.complete(meter)
        except KeyboardInterrupt:
            if not batches:
                batches.append(run.result())
            raise
        collect(batches, run.result())


def run_elsewhere(
    ensemble: Ensemble,
    states: Array | None,
    meter: Meter,
    batches: list[Batch],
    client: Any,
) -> None:
    """All batches on a client; they come back in their order."""
    if not hasattr(client, "submit"):
        raise TypeError(
            f"`client` must have a method submit(f, *args), got {client!r}; pass a "
            "dask.distributed client or an executor."
        )
    # Given points travel with their own batch only.
    given = isinstance(ensemble.law, GivenStart) or states is not None
    alone = replace(ensemble, law=None) if given else ensemble
    code = code_of(alone)
    futures: deque[tuple[int, Any]] = deque()
    for first, n in batches_of(ensemble.n_paths):
        state = part(states, first, n) if given else None
        if given and state is None:
            state = ensemble.initial_state(first, n)
        futures.append((n, client.submit(run_there, code, alone, first, n, state)))
    n_steps = ensemble.schedule.n_steps - ensemble.first_step
    while futures:
        n, future = futures.popleft()
        collect(batches, future.result())
        meter(n * n_steps)


def run_there(
    code: str | None, ensemble: Ensemble, first: int, n: int, state: Array | None
) -> Batch:
    """As `run_batch`, in another process: there a name may stand for other code."""
    if code is not None and code_of(ensemble) != code:
        raise RuntimeError(
            "`model`, or `initial`, is other code in the process of `client` than "
            "here, or of another version; restart this process and those of `client` "
            "so that all import the same."
        )
    return run_batch(ensemble, first, n, state)


def code_of(ensemble: Ensemble) -> str | None:
    """The code that decides the paths, as a digest without a machine's rounding."""
    return digest_or_none((Batch, ensemble.model, ensemble.law), sampled=False)


def collect(batches: list[Batch], batch: Batch) -> None:
    """Append a batch; histograms are added up at once, each is as large as the grid."""
    if batches and batch.counts.size:
        total = batches[0]
        total.counts[...] += batch.counts
        total.outside[...] += batch.outside
        batch = batch._replace(counts=NOTHING, outside=NOTHING)
    batches.append(batch)


def part(states: Array | None, first: int, n: int) -> Array | None:
    """States of some of the paths."""
    return None if states is None else states[:, first : first + n]


@contextmanager
def keeping_what_is_done(
    gather: Gather, ensemble: Ensemble, batches: list[Batch], watch: Stopwatch
) -> Iterator[None]:
    """Attach the finished batches to what stops the others."""
    try:
        yield
    except KeyboardInterrupt:
        done = None
        if batches:
            done = finished_part(gather, ensemble, batches, watch)
            done = replace(done, message="stopped by the user")
        raise RunInterrupted(done) from None
    except NonFinitePathError as error:
        if batches:
            done = finished_part(gather, ensemble, batches, watch)
            error.solution = replace(done, message=str(error))
        raise


def finished_part(
    gather: Gather, ensemble: Ensemble, batches: list[Batch], watch: Stopwatch
) -> Any:
    """The paths of the batches that are there, to where they came."""
    n_paths, reached = sum(batch.n for batch in batches), batches[0].step
    saves = ensemble.schedule.saves[: len(batches[0].sums)]
    schedule = replace(ensemble.schedule, n_steps=reached, saves=saves)
    fewer = replace(ensemble, n_paths=n_paths, schedule=schedule)
    provenance = watch.provenance(n_paths * reached)
    return replace(gather(fewer, batches, provenance), status="interrupted")


def gathered(
    make: Callable[..., Any],
    before: Any,
    call: Call,
    ensemble: Ensemble,
    batches: list[Batch],
    provenance: dict[str, Any],
) -> Any:
    """The paths of all batches as one result, from where `before` began."""
    schedule = ensemble.schedule
    start = np.concatenate([batch.start for batch in batches], axis=1)
    if before is not None:
        start = before.start[:, : ensemble.n_paths]
    return make(
        ensemble=replace(ensemble, first_step=0),
        s=np.array([schedule.s(step) for step in schedule.saves]),
        states=np.concatenate([batch.states for batch in batches], axis=2),
        sums=np.sum([batch.sums for batch in batches], axis=0),
        counts=batches[0].counts,
        outside=batches[0].outside,
        start=start,
        end=np.concatenate([batch.end for batch in batches], axis=1),
        provenance=provenance,
        call=call,
    )


def stepwise(
    s_start: float, s_end: float, ds: float, save_at: Iterable[float] | None
) -> Schedule:
    """Steps of exactly ds, whatever the end: a path must not depend on it."""
    span = check_real("s_start", s_start), check_real("s_end", s_end)
    schedule = make_schedule(span, ds, save_at, record_every=sys.maxsize, exact=True)
    return replace(schedule, records=())


def going_on(
    ensemble: Ensemble, s_end: float, save_at: Iterable[float] | None
) -> Ensemble:
    """The ensemble of the same paths from their end on to `s_end`."""
    if not ensemble.keep:
        raise ValueError(
            "the states must have been kept to go on, got paths sampled with "
            "keep=False; sample with keep=True."
        )
    ensemble.check_model()
    before = ensemble.schedule
    reached = before.s(before.n_steps)
    s_end = check_real("s_end", s_end)
    if not s_end > reached:
        raise ValueError(
            f"`s_end` must be beyond the end {reached:g} of the paths, got {s_end:g}."
        )
    schedule = stepwise(before.start, s_end, before.ds, save_at)
    ensemble.model.curve.check_span(schedule.start, schedule.end)
    if schedule.saves and schedule.saves[0] <= before.n_steps:
        raise ValueError(
            f"`save_at` must lie beyond the end {reached:g} of the paths, got "
            f"{schedule.s(schedule.saves[0]):g}."
        )
    longer = replace(ensemble, schedule=schedule, first_step=before.n_steps)
    check_memory(required_memory(longer), None, "save less often")
    return longer


def required_memory(ensemble: Ensemble) -> int:
    """Bytes of the result: states at every saved s and both ends, and histograms."""
    n_saved = len(ensemble.schedule.saves)
    state = 8 * ensemble.n_state * ensemble.n_paths
    kept = state * (n_saved + 2) if ensemble.keep else 0
    counted = 0 if ensemble.grid is None else ensemble.grid.nbytes * (n_saved + 2)
    return kept + counted + OVERHEAD
