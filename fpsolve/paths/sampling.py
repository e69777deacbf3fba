"""Sample the stochastic differential equation (6)."""

from __future__ import annotations

import math
import sys
import warnings
from collections import deque
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import check_numbers
from fpsolve._support.checks import (
    check_flag,
    check_integer,
    check_one_of,
    check_real,
    shown,
)
from fpsolve._support.memory import OVERHEAD, check_memory
from fpsolve._support.progress import ProgressCallback, reporting
from fpsolve._support.provenance import Stopwatch, announced_compilation
from fpsolve.errors import GridMismatchError, NonFinitePathError, RunInterrupted
from fpsolve.evolution.schedule import Schedule, make_schedule
from fpsolve.grids.phase_space import PhaseSpaceGrid, check_grid
from fpsolve.model.laydown import LayDownModel, check_model
from fpsolve.paths.batch import Batch, BatchRun, batches_of
from fpsolve.paths.elsewhere import check_repeats, code_of, run_there
from fpsolve.paths.ensemble import Ensemble, GivenStart
from fpsolve.paths.integrators import LARGEST_TURN, METHODS
from fpsolve.paths.laws import PointLaw
from fpsolve.paths.randomness import seed_number
from fpsolve.paths.result import Paths

__all__ = ["go_on", "sample_paths"]

Array = NDArray[np.float64]
NOTHING = np.zeros(0, dtype=np.int64)
CLOCKS = ("wall", "cpu")
# Paths that may end where a step is too long for the force.
LARGEST_SHARE = 0.01


def sample_paths(
    model: LayDownModel,
    n_paths: int,
    s_end: float,
    ds: float,
    *,
    seed: int | np.random.SeedSequence | None = None,
    rng: Any = None,
    initial: Any = None,
    save_at: Iterable[float] | None = None,
    s_start: float = 0.0,
    method: str = "splitting",
    histogram: PhaseSpaceGrid | None = None,
    keep: bool = True,
    client: Any = None,
    progress: bool | ProgressCallback = False,
    memory_limit: int | None = None,
) -> Paths:
    """Paths of dξ = τ(α) ds - dγ, dα = -∇B(ξ)·τ⊥(α) ds + A dW.

    The splitting T½ R½ D R½ T½ is weakly of order 2; it is exact in the angle for
    frozen ξ, and safe for A = 0, for any A √ds, and through the kink of B = ‖ξ‖. Path
    k depends on (seed, k, ds) alone: it is bitwise the same for any number of paths,
    of threads and of workers, and wherever it is saved.

    Parameters
    ----------
    model : LayDownModel
        Any potential and any curve. A potential of the user's own is evaluated by its
        Python functions, the others by compiled code.
    n_paths : int
    s_end : float
    ds : float
        Step; must divide the span.
    seed : int or SeedSequence
    rng : Generator, int or SeedSequence
        Instead of `seed`; a generator gives one number, the seed that is recorded.
    initial : law or pair of arrays, optional
        A law from `fpsolve.paths` (or any object with ``sample(rng, n)``), or arrays of
        shape (n_paths, 2) and (n_paths,) for ξ and α, or one point for all. By default
        ξ = 0, the point below the nozzle, and a uniform angle.
    save_at : iterable of float, optional
        Where to keep the paths; by default at the end.
    s_start : float
        Arclength at the start; it matters for curves that turn or swing.
    method : {"splitting", "euler_maruyama", "heun"}
    histogram : PhaseSpaceGrid, optional
        Count the paths in the cells of this grid at every saved s, while sampling.
    keep : bool
        False keeps no positions: memory then does not depend on `n_paths`.
    client : optional
        Where to compute: a dask.distributed client, or an executor of
        concurrent.futures; anything whose ``submit(f, *args)`` gives a future.
    progress : bool or callable
        Show a bar, or call with (path-steps done, path-steps in all, s).
    memory_limit : int, optional
        Bytes the result may take; by default what is available.

    Returns
    -------
    Paths

    Raises
    ------
    ValueError, TypeError
        Bad arguments.
    MemoryLimitError
        If the result would not fit into memory.
    NonFinitePathError
        If the gradient is not finite where a path comes.
    RunInterrupted
        On Ctrl-C, with the finished part of the paths as `.solution`.

    Warns
    -----
    UserWarning
        If |∇B| ds exceeds 2.5 where more than one path in a hundred ends: the method
        is not of its order there.

    References
    ----------
    [KMW09]_, section 3.1, equation (6).
    """
    check_model(model)
    n_paths = check_integer("n_paths", n_paths, 1)
    check_one_of("method", method, METHODS)
    check_histogram(histogram)
    schedule = stepwise(s_start, s_end, ds, save_at)
    model.curve.check_span(schedule.start, schedule.end)
    ensemble = Ensemble(
        model=model,
        n_paths=n_paths,
        schedule=schedule,
        seed=seed_number(seed, rng),
        method=method,
        law=law_of(initial, n_paths),
        keep=check_flag("keep", keep),
        grid=histogram,
    )
    remedy = "pass keep=False to keep no positions, save less often"
    check_memory(required_memory(ensemble), memory_limit, remedy)
    return completed(ensemble, None, client, progress)


def go_on(
    paths: Paths, s_end: float, save_at: Iterable[float] | None, progress: Any
) -> Paths:
    """The same paths from their end on to `s_end`."""
    if not paths.kept:
        raise ValueError(
            "the states must have been kept to go on, got paths sampled with "
            "keep=False; sample with keep=True."
        )
    paths.check_model()
    before = paths.ensemble.schedule
    reached = before.s(before.n_steps)
    s_end = check_real("s_end", s_end)
    if not s_end > reached:
        raise ValueError(
            f"`s_end` must be beyond the end {reached:g} of the paths, got {s_end:g}."
        )
    schedule = stepwise(before.start, s_end, before.ds, save_at)
    paths.ensemble.model.curve.check_span(schedule.start, schedule.end)
    if schedule.saves and schedule.saves[0] <= before.n_steps:
        raise ValueError(
            f"`save_at` must lie beyond the end {reached:g} of the paths, got "
            f"{schedule.s(schedule.saves[0]):g}."
        )
    ensemble = replace(paths.ensemble, schedule=schedule, first_step=before.n_steps)
    check_memory(required_memory(ensemble), None, "save less often")
    return completed(ensemble, paths, None, progress)


def completed(
    ensemble: Ensemble, before: Paths | None, client: Any, progress: Any
) -> Paths:
    """Run all batches, here or on a client, and gather them.

    Paths that go on from others become one with them: they begin where those began.
    """
    watch = Stopwatch()
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
        with keeping_what_is_done(ensemble, before, batches, watch):
            if client is None:
                run_here(ensemble, states, meter, batches)
            else:
                run_elsewhere(ensemble, states, meter, batches, client)
    warn_of_long_steps(ensemble, batches)
    n_total = ensemble.n_paths * ensemble.schedule.n_steps
    return gathered(ensemble, before, batches, watch.provenance(n_total))


def warn_of_long_steps(ensemble: Ensemble, batches: list[Batch]) -> None:
    """Warn if the step does not resolve the force where more than a few paths end."""
    n_fast = sum(batch.n_fast for batch in batches)
    allowed = LARGEST_SHARE * ensemble.n_paths
    # Three standard deviations: a few paths are no share of all.
    if n_fast > allowed + 3.0 * math.sqrt(allowed):
        share = n_fast / ensemble.n_paths
        warnings.warn(
            f"`ds` = {ensemble.schedule.ds:g} is long for this force: |∇B| ds exceeds "
            f"{LARGEST_TURN:g} where {100 * share:.2g} % of the paths end, and "
            "averages may be off by as much; compare with a shorter step",
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
    ensemble: Ensemble, before: Paths | None, batches: list[Batch], watch: Stopwatch
) -> Iterator[None]:
    """Attach the finished batches to what stops the others."""
    try:
        yield
    except KeyboardInterrupt:
        done = None
        if batches:
            done = finished_part(ensemble, before, batches, watch)
            done = replace(done, message="stopped by the user")
        raise RunInterrupted(done) from None
    except NonFinitePathError as error:
        if batches:
            done = finished_part(ensemble, before, batches, watch)
            error.solution = replace(done, message=str(error))
        raise


def finished_part(
    ensemble: Ensemble, before: Paths | None, batches: list[Batch], watch: Stopwatch
) -> Paths:
    """The paths of the batches that are there, to where they came."""
    n_paths, reached = sum(batch.n for batch in batches), batches[0].step
    saves = ensemble.schedule.saves[: len(batches[0].sums)]
    schedule = replace(ensemble.schedule, n_steps=reached, saves=saves)
    fewer = replace(ensemble, n_paths=n_paths, schedule=schedule)
    asked = ensemble.schedule
    provenance = {
        **watch.provenance(n_paths * reached),
        "asked": {
            "n_paths": ensemble.n_paths, "n_steps": asked.n_steps,
            "saves": list(asked.saves),
        },
    }  # fmt: skip
    return replace(gathered(fewer, before, batches, provenance), status="interrupted")


def gathered(
    ensemble: Ensemble,
    before: Paths | None,
    batches: list[Batch],
    provenance: dict[str, Any],
) -> Paths:
    """The paths of all batches as one result, from where `before` began."""
    schedule = ensemble.schedule
    start = np.concatenate([batch.start for batch in batches], axis=1)
    if before is not None:
        start = before.start[:, : ensemble.n_paths]
    return Paths(
        ensemble=replace(ensemble, first_step=0),
        s=np.array([schedule.s(step) for step in schedule.saves]),
        states=np.concatenate([batch.states for batch in batches], axis=2),
        sums=np.sum([batch.sums for batch in batches], axis=0),
        counts=batches[0].counts,
        outside=batches[0].outside,
        start=start,
        end=np.concatenate([batch.end for batch in batches], axis=1),
        provenance=provenance,
    )


def stepwise(
    s_start: float, s_end: float, ds: float, save_at: Iterable[float] | None
) -> Schedule:
    """Steps of exactly ds, whatever the end: a path must not depend on it."""
    span = check_real("s_start", s_start), check_real("s_end", s_end)
    schedule = make_schedule(span, ds, save_at, record_every=sys.maxsize, exact=True)
    return replace(schedule, records=())


def check_histogram(grid: Any) -> None:
    """Raise TypeError unless it is a grid or nothing."""
    if grid is not None:
        check_grid(grid, "histogram")


def law_of(initial: Any, n_paths: int) -> Any:
    """The law of the start, from any of the ways to give it."""
    if initial is None:
        return PointLaw()
    if hasattr(initial, "sample"):
        check_repeats(initial)
        return initial
    if not (isinstance(initial, tuple | list) and len(initial) == 2):
        raise TypeError(
            "`initial` must be a law with a method sample(rng, n), or a pair "
            f"(xi, alpha), got {shown(initial)}."
        )
    xi, alpha = (check_numbers("initial", points) for points in initial)
    if xi.shape not in ((2,), (n_paths, 2)):
        raise GridMismatchError((n_paths, 2), xi.shape, "initial xi")
    if alpha.shape not in ((), (n_paths,)):
        raise GridMismatchError((n_paths,), alpha.shape, "initial alpha")
    points = np.broadcast_to(xi, (n_paths, 2)), np.broadcast_to(alpha, (n_paths,))
    for name, values in zip(("xi", "alpha"), points, strict=True):
        if not np.isfinite(values).all():
            index = np.argwhere(~np.isfinite(values))[0]
            raise ValueError(
                f"`initial` must be finite, got {values[tuple(index)]:g} in {name} of "
                f"path {index[0]}."
            )
    return GivenStart(*points)


def required_memory(ensemble: Ensemble) -> int:
    """Bytes of the result: states at every saved s and both ends, and histograms."""
    n_saved = len(ensemble.schedule.saves)
    kept = 5 * 8 * ensemble.n_paths * (n_saved + 2) if ensemble.keep else 0
    counted = 0 if ensemble.grid is None else ensemble.grid.nbytes * (n_saved + 2)
    return kept + counted + OVERHEAD
