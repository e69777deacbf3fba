"""dm/ds = Q m for a reversible Markov generator Q, implicitly in s."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_one_of
from fpsolve._support.progress import ProgressCallback, reporting
from fpsolve.errors import RunInterrupted
from fpsolve.evolution.evolution import WithSeries
from fpsolve.evolution.richardson import extrapolated, extrapolated_series, gain_of
from fpsolve.evolution.schedule import Schedule
from fpsolve.reduced.entropy import Exchange, relative_entropy_of
from fpsolve.reduced.implicit import METHODS, Method
from fpsolve.reduced.step_errors import allowed_error, relaxation_lengths

__all__ = ["Relaxation", "completed", "relax", "relax_extrapolated"]


# What cells hold and rates sum to is a matter of rounding only.
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class Relaxation(WithSeries):
    """Cell masses that were saved, and series over every recorded step.

    Attributes
    ----------
    series : dict of ndarray, (n_recorded,)
        "s", "mass", "relative_entropy", "entropy_dissipation", "minimum": Σ m,
        H = Σ m ln(m/π), −dH/ds = −⟨Q m, ln(m/π)⟩ and min m; and Σ f m for each of the
        observables f asked for.
    saved_s : ndarray, shape (n_saved,)
    saved : ndarray, shape (n_saved, n)
    """

    series: Mapping[str, Array]
    saved_s: Array
    saved: Array


def relax(
    generator: Any,
    start: Array,
    equilibrium: Array,
    schedule: Schedule,
    *,
    method: str = "backward_euler",
    observables: Mapping[str, Array] | None = None,
    report: ProgressCallback | None = None,
) -> Relaxation:
    """dm/ds = Q m from given cell masses, implicitly, with the entropy on the way.

    Mass is kept to rounding. With "backward_euler" (order 1) masses stay positive and
    the entropy falls at every step, whatever ds; "sdirk2" (order 2, L-stable) promises
    neither, and a negative minimum is recorded, not clipped.

    Parameters
    ----------
    generator : sparse array, shape (n, n)
        Q: columns sum to zero, off-diagonal entries are non-negative rates, and
        Q_ij π_j = Q_ji π_i.
    start : ndarray, shape (n,)
        Cell masses at the start, of positive sum.
    equilibrium : ndarray, shape (n,)
        Cell masses π of the stationary law, of sum 1.
    schedule : Schedule
        Steps, records and saves.
    method : {"backward_euler", "sdirk2"}
    observables : dict of ndarray, shape (n,), optional
        Functions f of the cell, whose averages Σ f m are recorded too.
    report : callable, optional
        Called with (steps done, steps in all, s) after every record.

    Raises
    ------
    ValueError
        If the arguments do not fit each other.
    RunInterrupted
        After Ctrl-C; `solution` is the Relaxation of what was recorded.
    """
    check_arguments(generator, start, equilibrium, method)
    step: Method = METHODS[method](generator, schedule.ds)
    record = Record(generator, equilibrium, schedule, observables or {})
    mass = np.array(start, dtype=np.float64)
    total = float(mass.sum())
    record(0, mass)
    try:
        for first, last in schedule.legs():
            for _ in range(first, last):
                mass = step(mass)
                # Rounding alone changes the sum, by about 1e-16 ds ‖Q‖ a step and
                # always the same way; over a thousand steps that would show.
                mass *= total / mass.sum()
            record(last, mass)
            if report is not None:
                report(last, schedule.n_steps, schedule.s(last))
    except KeyboardInterrupt:
        raise RunInterrupted(record.relaxation()) from None
    return record.relaxation()


class Record:
    """Series and saved masses of one pass over a schedule."""

    def __init__(
        self,
        generator: Any,
        equilibrium: Array,
        schedule: Schedule,
        observables: Mapping[str, Array],
    ) -> None:
        self.exchange, self.equilibrium = Exchange(generator), equilibrium
        self.schedule, self.saves = schedule, frozenset(schedule.saves)
        self.observables = observables
        self.rows: list[dict[str, float]] = []
        self.saved: dict[int, Array] = {}

    def __call__(self, step: int, mass: Array) -> None:
        """Write down what the masses are after a number of steps."""
        self.rows.append({
            "s": self.schedule.s(step),
            "mass": float(mass.sum()),
            "relative_entropy": relative_entropy_of(mass, self.equilibrium),
            "entropy_dissipation": self.exchange(mass),
            "minimum": float(mass.min()),
            **{name: float(f @ mass) for name, f in self.observables.items()},
        })  # fmt: skip
        if step in self.saves:
            self.saved[step] = mass.copy()

    def relaxation(self) -> Relaxation:
        """What was written down."""
        series = {name: np.array([row[name] for row in self.rows])
                  for name in self.rows[0]}  # fmt: skip
        saved_s = np.array([self.schedule.s(step) for step in self.saved])
        saved = np.array(list(self.saved.values()))
        return Relaxation(
            series, saved_s, saved.reshape(len(saved_s), len(self.equilibrium))
        )


def relax_extrapolated(
    generator: Any,
    start: Array,
    equilibrium: Array,
    schedule: Schedule,
    *,
    method: str = "backward_euler",
    observables: Mapping[str, Array] | None = None,
    report: ProgressCallback | None = None,
) -> tuple[Relaxation, dict[str, Array]]:
    """Two runs of `relax` combined: u = (2^q u_{ds/2} − u_{ds})/(2^q − 1).

    Saved masses, averages, entropy and dissipation are extrapolated separately; the
    mass is not an approximation, and the minimum is that of the finer run. The
    estimates are the error of the finer run, an upper bound of that of the
    extrapolated values: of a series the largest nearby, as its difference may change
    its sign; and the whole difference or more in the first steps, where a rough start
    has no expansion in ds. A ds beyond two time scales of the slowest mode comes with
    a warning. Extrapolated masses need not be positive.

    Parameters as for `relax`. The result has the stops of the run with ds. Ctrl-C in
    the second run leaves the first one, finished and not extrapolated.

    Returns
    -------
    Relaxation
    dict of ndarray
        Errors of "relative_entropy", "entropy_dissipation" and the averages,
        (n_recorded,), and "saved_l1" (n_saved,): Σ |error| of the saved masses.

    References
    ----------
    [Ric11]_.
    """

    def run(stops: Schedule, n_before: int) -> Relaxation:
        told = _shifted(report, n_before, 3 * schedule.n_steps)
        return relax(generator, start, equilibrium, stops, method=method,
                     observables=observables, report=told)  # fmt: skip

    coarse = run(schedule, 0)
    try:
        fine = run(schedule.refined(), schedule.n_steps)
    except RunInterrupted:
        raise RunInterrupted(coarse) from None
    gain, ds, begun = gain_of(METHODS[method].order), schedule.ds, fine.s[0]
    series, errors = extrapolated_series(
        fine.series, coarse.series, gain,
        relaxation_lengths(fine.relative_entropy, fine.entropy_dissipation, ds),
        allowed_error(fine.s - begun, ds, gain), _approximates,
    )  # fmt: skip
    change: Array = np.abs(fine.saved - coarse.saved).sum(axis=1)
    errors = {name: error for name, error in errors.items() if _approximates(name)}
    errors["saved_l1"] = allowed_error(fine.saved_s - begun, ds, gain) * change
    saved = extrapolated(fine.saved, coarse.saved, gain)
    return Relaxation(series, fine.saved_s, saved), errors


def _approximates(name: str) -> bool:
    return name not in ("s", "mass", "minimum")


def completed(
    make: Callable[[Relaxation, Mapping[str, Array] | None, str], Any],
    *problem: Any,
    extrapolate: bool,
    progress: bool | ProgressCallback,
    **options: Any,
) -> Any:
    """The result that `make` makes of a run, or of two with their errors.

    Parameters
    ----------
    make : callable
        Takes the relaxation, errors or None, and the status.
    *problem, **options
        Arguments of `relax`.

    Raises
    ------
    RunInterrupted
        After Ctrl-C, with the result of what was recorded.
    """
    with reporting(progress) as report:
        try:
            if extrapolate:
                found, errors = relax_extrapolated(*problem, report=report, **options)
                return make(found, errors, "finished")
            return make(relax(*problem, report=report, **options), None, "finished")
        except RunInterrupted as interrupt:
            partial = make(interrupt.solution, None, "interrupted")
            raise RunInterrupted(partial) from None


def _shifted(
    report: ProgressCallback | None, n_before: int, n_total: int
) -> ProgressCallback | None:
    """A report that counts the steps of an earlier run too."""
    if report is None:
        return None
    return lambda n_done, _, s: report(n_before + n_done, n_total, s)


def check_arguments(
    generator: Any, start: Array, equilibrium: Array, method: str
) -> None:
    """Raise ValueError unless the arguments of `relax` fit each other."""
    check_one_of("method", method, METHODS)
    n = generator.shape[0]
    for name, masses in (("start", start), ("equilibrium", equilibrium)):
        if np.shape(masses) != (n,):
            raise ValueError(
                f"`{name}` must have the shape {(n,)} of the generator's cells, got "
                f"{np.shape(masses)}."
            )
        # NaN and infinity anywhere show in the sum.
        if not 0 < np.sum(masses) < np.inf:
            raise ValueError(
                f"`{name}` must be finite with positive mass, got a mass of "
                f"{np.sum(masses):g}."
            )
    if not np.min(equilibrium) >= 0:
        raise ValueError(
            "`equilibrium` must be non-negative, got a minimum of "
            f"{np.min(equilibrium):g}."
        )
    largest = float(np.abs(generator.diagonal()).max())
    lost = float(np.abs(generator.sum(axis=0)).max())
    if not lost <= _ROUNDING * largest:
        raise ValueError(
            "`generator` must keep the mass: its columns must sum to zero, got "
            f"{lost:.2g} beside rates of {largest:.2g}."
        )
