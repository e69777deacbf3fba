"""Evolve a density: the loop, its checks and its records."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from fpsolve.errors import (
    DomainTooSmallError,
    MassDriftError,
    NegativeDensityError,
    NonFiniteDensityError,
    RunError,
    RunInterrupted,
)
from fpsolve.extrapolation import extrapolated
from fpsolve.grids import PhaseSpaceGrid
from fpsolve.memory import check_memory, required_memory
from fpsolve.models import LayDownModel
from fpsolve.progress import ProgressCallback, reporting
from fpsolve.provenance import Stopwatch, announced_compilation
from fpsolve.recording import Recorder
from fpsolve.schedule import Schedule, make_schedule
from fpsolve.schemes.form import State
from fpsolve.solution import Solution

__all__ = ["Scheme", "solve"]

Array = NDArray[np.float64]


class Scheme(Protocol):
    """What `solve` needs of a scheme; see docs/extending.md."""

    name: str
    order: int
    model: LayDownModel
    grid: PhaseSpaceGrid
    correction_limit: float

    @property
    def options(self) -> dict[str, Any]: ...  # noqa: D102
    @property
    def n_arrays(self) -> float: ...  # noqa: D102
    def start(self, p0: Array) -> State: ...  # noqa: D102
    def density(self, state: State) -> Array: ...  # noqa: D102
    def advance(self, state: State, s: float, ds: float, n_steps: int = 1) -> None: ...  # noqa: D102


def solve(
    scheme: Scheme,
    p0: Array,
    s_span: tuple[float, float],
    ds: float,
    *,
    save_at: Iterable[float] | None = None,
    extrapolate: bool = False,
    progress: bool | ProgressCallback = False,
    mass_tolerance: float = 1e-10,
    boundary_tolerance: float = 1e-3,
    negative_tolerance: float = 0.2,
    reference: Array | None = None,
    record_every: int = 1,
    memory_limit: int | None = None,
) -> Solution:
    """Density p(ξ, α, s) of equation (7) from p0, with its entropy at every step.

    Nothing a run has computed is lost: every error raised while it runs, and the
    `RunInterrupted` that Ctrl-C becomes, carries what was recorded as `.solution`.

    Parameters
    ----------
    scheme : Scheme
        From `drift_kick` or `semi_lagrangian`.
    p0 : ndarray, shape (n1, n2, n_alpha)
        Initial density.
    s_span : (float, float)
        Arclength at the start and at the end.
    ds : float
        Step; must divide the span. `suggest_step` proposes one.
    save_at : iterable of float, optional
        Where to keep the density; by default at the end.
    extrapolate : bool
        Run with ds and ds/2, combine both to cancel the leading error in ds
        (Richardson) and attach error estimates for everything that is returned.
    progress : bool or callable
        Show a bar, or call with (steps done, steps in all, s).
    mass_tolerance : float
        Largest relative drift of the mass.
    boundary_tolerance : float
        Largest share of mass in the outermost cells.
    negative_tolerance : float
        Largest ∫ max(−p, 0), relative to the mass. Undershoot of a few percent is
        what high-order interpolation leaves beside fronts.
    reference : ndarray, optional
        Density the entropy is relative to; p_S by default.
    record_every : int
        Steps between two records. Steps in between are cheaper: neighbouring half
        steps merge.
    memory_limit : int, optional
        Bytes the run may use; by default what is available.

    Returns
    -------
    Solution

    Raises
    ------
    ValueError, GridMismatchError, MemoryLimitError
        Before the run: bad arguments, p0 on another grid, too large a run.
    NonFiniteDensityError, MassDriftError, NegativeDensityError, DomainTooSmallError
        During the run, each with its numbers and the partial solution; so is
        `MassCorrectionError` of the semi-Lagrangian scheme.
    """
    p0 = checked_start(scheme, p0)
    tolerances = Tolerances(mass_tolerance, boundary_tolerance, negative_tolerance)
    schedule = make_schedule(s_span, ds, save_at, record_every)
    required = required_memory(
        scheme.grid.nbytes, scheme.n_arrays, len(schedule.saves), extrapolate
    )
    check_memory(required, memory_limit)
    with reporting(progress) as report, announced_compilation(bool(progress)):
        n_total = schedule.n_steps * (3 if extrapolate else 1)
        coarse = Run(scheme, p0, schedule, reference, tolerances)
        solution = coarse.complete(report, 0, n_total)
        if extrapolate:
            fine = Run(scheme, p0, schedule.refined(), reference, tolerances)
            refined = fine.complete(
                report, schedule.n_steps, n_total, fallback=solution
            )
            solution = extrapolated(solution, refined, scheme.order)
    return solution


@dataclass(frozen=True)
class Tolerances:
    """What a run puts up with before it stops."""

    mass: float
    boundary: float
    negative: float

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not value > 0:
                raise ValueError(f"`{name}_tolerance` must be positive, got {value:g}.")


def checked_start(scheme: Scheme, p0: Array) -> Array:
    """The initial density if it fits the scheme's grid and is finite with mass."""
    p0 = scheme.grid.check(p0, "p0")
    if not np.isfinite(p0).all():
        index = tuple(int(i) for i in np.argwhere(~np.isfinite(p0))[0])
        raise ValueError(f"`p0` must be finite, got {p0[index]:g} at index {index}.")
    if not p0.sum() > 0:
        raise ValueError(f"`p0` must have positive mass, got {p0.sum():g}.")
    return p0


class Run:
    """One pass over a schedule."""

    def __init__(
        self,
        scheme: Scheme,
        p0: Array,
        schedule: Schedule,
        reference: Array | None,
        tolerances: Tolerances,
    ) -> None:
        self.scheme, self.schedule = scheme, schedule
        self.recorder = Recorder(scheme.model, scheme.grid, reference)
        self.tolerances = tolerances
        self.state = scheme.start(p0)
        self.saved: list[tuple[float, Array]] = []
        self.watch = Stopwatch()

    def complete(
        self,
        report: ProgressCallback,
        n_before: int,
        n_total: int,
        fallback: Solution | None = None,
    ) -> Solution:
        """Run to the end; what stops it leaves with the partial solution.

        With extrapolation the finished run at ds is the `fallback`: it is what is
        left when the one at ds/2 stops.
        """
        try:
            self._record(0)
            report(n_before, n_total, self.schedule.start)
            for first, last in self.schedule.legs():
                s = self.schedule.s(first)
                self.scheme.advance(self.state, s, self.schedule.ds, last - first)
                self._record(last)
                report(n_before + last, n_total, self.schedule.s(last))
        except RunError as error:
            error.solution = self._partial("failed", str(error), fallback)
            raise
        except KeyboardInterrupt:
            partial = self._partial("interrupted", "stopped by the user", fallback)
            raise RunInterrupted(partial) from None
        return self._solution("finished", "")

    def _record(self, step: int) -> None:
        s = self.schedule.s(step)
        p = self.scheme.density(self.state)
        extra = {"mass_correction": self.state.correction}
        if self.state.theta is not None:
            extra["theta"] = self.state.theta
        self._check_finite(p, s)
        values = self.recorder.record(p, s, **extra)
        if step in self.schedule.saves:
            self.saved.append((s, p.copy()))
        self._check(values)

    def _check_finite(self, p: Array, s: float) -> None:
        # A sum is finite unless a cell is not, or the values are about to overflow.
        if not math.isfinite(float(p.sum())):
            bad = np.argwhere(~np.isfinite(p))
            index = bad[0] if len(bad) else np.unravel_index(np.argmax(p), p.shape)
            raise NonFiniteDensityError(s, tuple(int(i) for i in index))

    def _check(self, values: dict[str, float]) -> None:
        s = values["s"]
        drift = values["mass"] / self.recorder.rows[0]["mass"] - 1.0
        allowed = self.tolerances
        if not abs(drift) <= allowed.mass:
            raise MassDriftError(s, drift, allowed.mass)
        if not abs(self.state.correction) <= self.scheme.correction_limit:
            raise MassDriftError(s, self.state.correction, self.scheme.correction_limit)
        negative = values["negative_mass"] / values["mass"]
        if not negative <= allowed.negative:
            raise NegativeDensityError(s, negative, allowed.negative)
        if not values["boundary_mass"] <= allowed.boundary:
            raise DomainTooSmallError(
                values["boundary_mass"],
                self.scheme.grid.half_width,
                s,
                allowed.boundary,
            )

    def _partial(
        self, status: str, message: str, fallback: Solution | None
    ) -> Solution:
        if fallback is None:
            return self._solution(status, message)
        message += " (in the run at ds/2: this is the one at ds, not extrapolated)"
        return replace(fallback, status=status, message=message)

    def _solution(self, status: str, message: str) -> Solution:
        shape = self.scheme.grid.shape
        description = {
            "name": self.scheme.name,
            "order": self.scheme.order,
            "options": dict(self.scheme.options),
        }
        return Solution(
            model=self.scheme.model,
            grid=self.scheme.grid,
            scheme=description,
            ds=self.schedule.ds,
            series=self.recorder.series(),
            saved_s=np.array([s for s, _ in self.saved]),
            densities=np.array([p for _, p in self.saved]).reshape(-1, *shape),
            entropy_floor=self.recorder.floor(),
            status=status,
            message=message,
            provenance=self.watch.provenance(self.state.n_steps),
        )
