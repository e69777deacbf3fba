"""Evolve a density: its arguments, checked."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from contextlib import AbstractContextManager, nullcontext
from functools import partial
from typing import Any

from fpsolve._kernels.threads import threads_worth_their_wait
from fpsolve._support.arrays import Array
from fpsolve._support.blas import one_blas_thread
from fpsolve._support.memory import check_memory, required_memory
from fpsolve._support.progress import ProgressCallback, reporting
from fpsolve._support.provenance import announced_compilation
from fpsolve.density.arrays.array_drift_kick import where_p0_lies
from fpsolve.density.arrays.library import brought
from fpsolve.density.checkpoints.checkpoint import Checkpoint, as_checkpoint
from fpsolve.density.keeper import MemoryKeeper
from fpsolve.density.levels import MOST_LEVELS, checked_levels, n_passes
from fpsolve.density.observed import Observe, described_observed, observed_series
from fpsolve.density.passes import Keepers, run_passes, run_within
from fpsolve.density.run import Run
from fpsolve.density.schemes.dictionaries import described_scheme
from fpsolve.density.schemes.scheme import Scheme, checked_scheme, checked_start
from fpsolve.density.smooth.recorder import recorder_for
from fpsolve.density.solution import Solution
from fpsolve.density.step_choice import chosen_step
from fpsolve.density.tolerances import Tolerances
from fpsolve.evolution.call import Call, Kept
from fpsolve.evolution.schedule import Schedule, checked_stops, make_schedule
from fpsolve.grids.reference import checked_reference

__all__ = ["solve"]


@one_blas_thread()
def solve(
    scheme: Scheme,
    p0: Array,
    s_span: tuple[float, float],
    ds: float | None = None,
    *,
    save_at: Iterable[float] | None = None,
    extrapolate: bool | int = False,
    tolerance: float | None = None,
    progress: bool | ProgressCallback = False,
    mass_tolerance: float = 1e-10,
    boundary_tolerance: float = 1e-3,
    negative_tolerance: float = 0.2,
    entropy_tolerance: float = 0.1,
    circulation_tolerance: float = 0.05,
    reference: Array | None = None,
    record_every: int = 1,
    memory_limit: int | None = None,
    checkpoint: Checkpoint | str | os.PathLike[str] | None = None,
    observe: Observe | None = None,
) -> Solution:
    """Density p(ξ, α, s) of (7), or of (23) with κ, from p0; entropy at every step.

    Nothing a run has computed is lost: every error raised while it runs, and the
    `RunInterrupted` that Ctrl-C becomes, carries what was recorded as `.solution`.

    Parameters
    ----------
    scheme : Scheme
        From `drift_kick` or `semi_lagrangian`, of a smooth fibre `smooth_drift_kick`.
    p0 : ndarray, shape (n1, n2, n_alpha)
        Initial density; with a curvature (n1, n2, n_alpha, n_kappa). A float64 array
        of another library, such as jax or cupy, is evolved there by `drift_kick`,
        unless it is positive; the solution is on the host as ever.
    s_span : (float, float)
        Arclength at the start and at the end.
    ds : float, optional
        Step; must divide the span. `suggest_step` proposes one. With `tolerance` the
        longest that is tried, by default one that resolves the law.
    save_at : iterable of float, optional
        Where to keep the density; by default at the end.
    extrapolate : bool or int
        Run with ds and ds/2, combine both to cancel the leading error in ds
        (Richardson) and attach error estimates for everything that is returned. A
        number n from 2 to 8 runs with ds, ds/2, …, ds/n and combines all of them to
        order 2n (Aitken, Neville), for a scheme whose error has even powers of ds only.
    tolerance : float, optional
        L1 error of the saved densities that is to be left, of the step and of the
        cells, for drift_kick with `translation="fourier"`. Chooses ds and the number of
        levels: one is added until the estimate is below, and the step is halved where
        more levels do not help. `ds` and `provenance["levels"]` of the solution tell
        what was done.
    progress : bool or callable
        Show a bar, or call with (steps done, steps in all, s).
    mass_tolerance : float
        Largest relative drift of the mass.
    boundary_tolerance : float
        Largest share of mass in the outermost cells, of ξ and of κ.
    negative_tolerance : float
        Largest ∫ max(−p, 0), relative to the mass. Undershoot of a few percent is
        what high-order interpolation leaves beside fronts.
    entropy_tolerance : float
        Largest rise of H(p|p_S) above an earlier value on a belt at rest, where it can
        only fall.
    circulation_tolerance : float
        Largest deviation of E G/max|G|, G = e^{−B} (ξ₁ sin α − ξ₂ cos α), from its
        exact law e^{−A²s/2}, for isotropic B on a belt at rest. The L1 error of the
        density is at least that.
    reference : ndarray, optional
        Density the entropy is relative to; p_S by default, and nothing of a smooth
        fibre, for which p_S is not stationary: that of `steady_state(scheme, ds=ds)`
        is what the run tends to. Below zero, up to 1e-3 of the mass, it counts as zero.
    record_every : int
        Steps between two records. Steps in between are cheaper: neighbouring half
        steps merge.
    memory_limit : int, optional
        Bytes the run may use; by default what is available.
    checkpoint : Checkpoint or path, optional
        Folder in which the run keeps what it needs to go on after a kill, by default
        every minute. If it holds a checkpoint of the same run, that one goes on: the
        result is bitwise that of an uninterrupted run. Saved densities are then on
        the disk, and `densities` of the result are read from the folder
        when they are asked for: keep it as long as you use them. See `resume`.
    observe : mapping of callables, optional
        Numbers of your own: ``observe={"returning": f}`` records ``f(p, grid)`` with
        every record, as the series `returning` of the solution.

    Returns
    -------
    Solution

    Raises
    ------
    ValueError, GridMismatchError, MemoryLimitError
        Before the run: bad arguments, p0 on another grid, too large a run.
    NonFiniteDensityError, MassDriftError, NegativeDensityError, DomainTooSmallError
        During the run, each with its numbers and the partial solution; so is
        `MassCorrectionError` of the semi-Lagrangian scheme, and `CurvatureRangeError`
        of a smooth fibre.
    EntropyRiseError, CirculationError
        Likewise, where a run on a belt at rest breaks a law of the equation.
    ObservationError
        Likewise, where a function of `observe` fails or gives no finite number.
    CheckpointMismatchError
        If the folder holds the checkpoint of another run; names every difference.
    ToleranceError
        If no step and no number of levels reaches `tolerance`; the best is its
        `.solution`.
    CheckpointError
        If a checkpoint cannot be written. The last good one is kept.

    References
    ----------
    [KMW09]_, equations (7) and (11); extrapolation as in [Ric11]_ and [Gragg65]_.
    """
    kept = checkpoint is not None
    scheme, p0 = where_p0_lies(checked_scheme(scheme), p0, kept)
    p0 = checked_start(scheme, p0)
    extrapolate = checked_levels(scheme, extrapolate)
    if reference is not None:
        reference = checked_reference(brought(reference), scheme.grid)
    tolerances = Tolerances(
        mass_tolerance, boundary_tolerance, negative_tolerance, entropy_tolerance,
        circulation_tolerance,
    )  # fmt: skip
    observed = observed_series(observe)
    save_at = None if save_at is None else tuple(checked_stops(save_at))
    ds = chosen_step(scheme, s_span, save_at, ds, extrapolate, tolerance)
    schedule = make_schedule(s_span, ds, save_at, record_every)
    scheme.model.curve.check_span(schedule.start, schedule.end)
    # Two for writing, where saved densities do not stay. Every pass but the last
    # leaves its initial density.
    n_kept = len(schedule.saves) if checkpoint is None else 2
    passes = n_passes(extrapolate) if tolerance is None else MOST_LEVELS
    required = required_memory(
        scheme.grid.nbytes, scheme.n_arrays + passes - 1, n_kept, passes
    )
    check_memory(required, memory_limit)
    call = Call.of("solve", {
        "scheme": described_scheme(scheme),
        "p0": Kept("initial_density", p0),
        "s_span": [float(s) for s in s_span],
        "ds": float(ds),
        "save_at": save_at,
        "extrapolate": extrapolate,
        "tolerance": None if tolerance is None else float(tolerance),
        **{f"{name}_tolerance": float(one) for name, one in vars(tolerances).items()},
        "reference": None if reference is None else Kept("reference", reference),
        "record_every": int(record_every),
        "observe": described_observed(observe, kept),
    })  # fmt: skip
    arrays = {"p0": p0, "reference": reference, "save_at": save_at}
    with (
        threads_worth_their_wait(p0.size),
        _keepers(checkpoint, call, scheme, arrays, schedule) as keepers,
        reporting(progress) as report,
        announced_compilation(bool(progress)),
    ):
        recorder = recorder_for(scheme, reference, observed)
        begin = partial(Run, scheme, p0, reference, recorder, tolerances, call)
        if tolerance is None:
            return run_passes(begin, keepers, schedule, extrapolate, report)
        return run_within(begin, keepers, schedule, tolerance, report)


def _keepers(
    checkpoint: Checkpoint | str | os.PathLike[str] | None,
    call: Call,
    scheme: Scheme,
    arrays: Mapping[str, Any],
    schedule: Schedule,
) -> AbstractContextManager[Keepers]:
    """What makes the keepers of the passes."""
    if checkpoint is None:
        shape = scheme.grid.shape
        return nullcontext(lambda name, one: MemoryKeeper(shape, len(one.saves)))
    # zarr and its locks are loaded for those who ask for them.
    from fpsolve.density.checkpoints.folder import opened_folder
    from fpsolve.density.checkpoints.identity import identified

    run = identified(call, scheme, arrays["p0"], schedule)
    return opened_folder(as_checkpoint(checkpoint), run, arrays)
