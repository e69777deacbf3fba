"""dm/ds = Q m for a reversible Markov generator Q, implicitly in s."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.checks import check_one_of
from fpsolve._support.progress import ProgressCallback
from fpsolve.errors import RunInterrupted
from fpsolve.evolution.richardson import gain_of
from fpsolve.evolution.schedule import Schedule
from fpsolve.reduced.entropy import Exchange, relative_entropy_of
from fpsolve.reduced.implicit import METHODS, Method
from fpsolve.reduced.step_errors import StepErrors

__all__ = ["Relaxation", "extrapolated_relaxation", "relax", "relax_extrapolated"]

Array = NDArray[np.float64]

# What cells hold and rates sum to is a matter of rounding only.
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class Relaxation:
    """Cell masses that were saved, and series over every recorded step.

    Attributes
    ----------
    s, mass, relative_entropy, entropy_dissipation, minimum : ndarray, (n_recorded,)
        Σ m, H = Σ m ln(m/π), −dH/ds = −⟨Q m, ln(m/π)⟩ and min m.
    saved_s : ndarray, shape (n_saved,)
    saved : ndarray, shape (n_saved, n)
    averages : dict of ndarray, (n_recorded,)
        Σ f m for each of the observables f asked for.
    """

    s: Array
    mass: Array
    relative_entropy: Array
    entropy_dissipation: Array
    minimum: Array
    saved_s: Array
    saved: Array
    averages: Mapping[str, Array] = field(default_factory=dict)


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
        self.averages: dict[str, list[float]] = {name: [] for name in observables}
        self.rows: list[tuple[float, ...]] = []
        self.saved: list[Array] = []

    def __call__(self, step: int, mass: Array) -> None:
        """Write down what the masses are after a number of steps."""
        entropy = relative_entropy_of(mass, self.equilibrium)
        dissipation, least = self.exchange(mass), float(mass.min())
        total = float(mass.sum())
        self.rows.append((self.schedule.s(step), total, entropy, dissipation, least))
        for name, values in self.observables.items():
            self.averages[name].append(float(values @ mass))
        if step in self.saves:
            self.saved.append(mass.copy())

    def relaxation(self) -> Relaxation:
        """What was written down."""
        reached = self.schedule.saves[: len(self.saved)]
        saved_s = np.array([self.schedule.s(step) for step in reached])
        saved = np.array(self.saved).reshape(len(saved_s), len(self.equilibrium))
        averages = {name: np.array(row) for name, row in self.averages.items()}
        series = zip(*self.rows, strict=True)
        s, mass, entropy, dissipation, least = (np.array(row) for row in series)
        return Relaxation(
            s, mass, entropy, dissipation, least, saved_s, saved, averages
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
    """Two runs of `relax`, with ds and ds/2, combined; see `extrapolated_relaxation`.

    Parameters as for `relax`. The result has the stops of the run with ds. Ctrl-C in
    the second run leaves the first one, finished and not extrapolated.
    """

    def run(stops: Schedule, n_before: int) -> Relaxation:
        return relax(
            generator,
            start,
            equilibrium,
            stops,
            method=method,
            observables=observables,
            report=_shifted(report, n_before, 3 * schedule.n_steps),
        )

    coarse = run(schedule, 0)
    try:
        fine = run(schedule.refined(), schedule.n_steps)
    except RunInterrupted:
        raise RunInterrupted(coarse) from None
    return extrapolated_relaxation(coarse, fine, METHODS[method].order, schedule.ds)


def extrapolated_relaxation(
    coarse: Relaxation, fine: Relaxation, order: int, ds: float
) -> tuple[Relaxation, dict[str, Array]]:
    """u = (2^q u_{ds/2} − u_{ds})/(2^q − 1), and |u_{ds/2} − u_{ds}|/(2^q − 1).

    Saved masses, averages, entropy and dissipation are extrapolated separately; the
    mass is not an approximation, and the minimum is that of the finer run. The
    estimates are the error of the finer run, an upper bound of that of the
    extrapolated values: of a series the largest nearby, as its difference may change
    its sign; and the whole difference or more in the first steps, where a rough start
    has no expansion in ds. A ds beyond two time scales of the slowest mode comes with
    a warning. Extrapolated masses need not be positive.

    Returns
    -------
    Relaxation
    dict of ndarray
        "relative_entropy", "entropy_dissipation" and the averages, (n_recorded,), and
        "saved_l1" (n_saved,): Σ |error| of the saved masses.

    References
    ----------
    [Ric11]_.
    """
    gain = gain_of(order)
    estimates = StepErrors(fine, ds, gain)
    better: dict[str, Any] = {}
    errors: dict[str, Array] = {}
    for name in ("relative_entropy", "entropy_dissipation"):
        change = getattr(fine, name) - getattr(coarse, name)
        better[name] = getattr(fine, name) + gain * change
        errors[name] = estimates.of_series(change)
    averages = {}
    for name, values in fine.averages.items():
        change = values - coarse.averages[name]
        averages[name], errors[name] = (
            values + gain * change,
            estimates.of_series(change),
        )
    change = fine.saved - coarse.saved
    errors["saved_l1"] = estimates.of_saved(change)
    saved = fine.saved + gain * change
    return replace(fine, saved=saved, averages=averages, **better), errors


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
