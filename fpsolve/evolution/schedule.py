"""Steps of a run: when to record, when to save."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.checks import check_integer, check_real, shown, told_apart

__all__ = [
    "Schedule",
    "index_of",
    "make_schedule",
    "same_arclength",
    "saved_index",
    "step_dividing",
]

# How far an arclength may be from the one that is meant: relative to its size, or to 1
# where it is smaller, which is half a unit of the sixth digit; as a share of the steps,
# which it must tell apart; and what the rounding of s = start + n ds may leave.
TYPED, OF_A_STEP, ROUNDED = 5e-6, 1e-3, 8 * 2.0**-52
# Beyond this many steps s = start + n ds is no longer a different number for each n.
MOST_STEPS = 2**53
# Each takes some 120 bytes.
MOST_RECORDS = 10**7


@dataclass(frozen=True)
class Schedule:
    """n_steps steps of ds from start, and the step numbers at which to stop.

    Attributes
    ----------
    start, ds : float
    n_steps : int
    records : tuple of int
        Steps at which diagnostics are recorded, beginning with 0.
    saves : tuple of int
        Steps at which the density is kept; a subset of `records`.
    """

    start: float
    ds: float
    n_steps: int
    records: tuple[int, ...]
    saves: tuple[int, ...]

    def s(self, step: int) -> float:
        """Arclength after a number of steps."""
        return self.start + step * self.ds

    @property
    def end(self) -> float:
        """Arclength after the last step."""
        return self.s(self.n_steps)

    def legs(self) -> Iterator[tuple[int, int]]:
        """Pairs (from, to) of neighbouring records."""
        return zip(self.records[:-1], self.records[1:], strict=True)

    def refined(self, by: int = 2) -> Schedule:
        """The same stops with the step divided by `by`."""
        return Schedule(
            self.start,
            self.ds / by,
            by * self.n_steps,
            tuple(by * step for step in self.records),
            tuple(by * step for step in self.saves),
        )


def make_schedule(
    s_span: tuple[float, float],
    ds: float,
    save_at: Iterable[float] | None = None,
    record_every: int = 1,
    *,
    exact: bool = False,
) -> Schedule:
    """Steps of a run over `s_span`, checked.

    ds is changed by what is missing to divide the span, at most 5e-6 of it, unless it
    is to be `exact`.

    Raises
    ------
    ValueError
        If ds is not positive, does not divide the span, or a saving point is not a
        step.
    TypeError
        If `record_every` is not an integer.
    """
    start, end = checked_span(s_span)
    if not (math.isfinite(start) and math.isfinite(end) and end > start):
        raise ValueError(
            f"`s_span` must be (start, end) with start < end, got ({start:g}, {end:g})."
        )
    ds = check_real("ds", ds)
    if not (math.isfinite(ds) and ds > 0):
        raise ValueError(f"`ds` must be positive, got {ds:g}.")
    record_every = check_integer("record_every", record_every, at_least=1)
    check_number_of_steps((end - start) / ds, end - start, ds, record_every)
    n_steps = round((end - start) / ds)
    fits = n_steps > 0 and abs(n_steps * ds - (end - start)) <= TYPED * ds * n_steps
    if not fits or (exact and not same_arclength(start + n_steps * ds, end, ds)):
        n_better = max(1, math.ceil((end - start) / ds * (1 - TYPED)))
        raise ValueError(
            f"`ds` must divide the span {end - start:g} into whole steps, got {ds:g}; "
            f"use ds = {(end - start) / n_better:.12g}."
        )
    ds = ds if exact else (end - start) / n_steps
    stops = (end,) if save_at is None else checked_stops(save_at)
    saves = tuple(sorted({_step_of(s, start, ds, n_steps) for s in stops}))
    records = sorted({*range(0, n_steps, record_every), n_steps, *saves})
    return Schedule(start, ds, n_steps, tuple(records), saves)


def step_dividing(stops: Iterable[float], longest: float, most: int) -> float | None:
    """Longest step, at most `longest`, of which every stop is a multiple.

    Parameters
    ----------
    stops : iterable of float
        Arclengths from 0, the end of the run the last of them.
    longest : float
    most : int
        None that is shorter than longest/most is looked for: what has only such a
        step has no sensible one.

    Returns
    -------
    float or None
    """
    s = np.array(list(stops))
    end = float(s[-1])
    fewest = math.ceil(end / longest - 1e-9)
    for n_steps in range(fewest, most * fewest):
        places = s * (n_steps / end)
        if np.all(np.abs(places - np.round(places)) < 1e-6):
            return end / n_steps
    return None


def checked_span(s_span: Any) -> tuple[float, float]:
    """The two ends as floats; TypeError unless they are two numbers."""
    try:
        if isinstance(s_span, str | bytes):
            raise TypeError
        start, end = s_span
        return check_real("s_span", start), check_real("s_span", end)
    except (TypeError, ValueError):
        raise TypeError(
            f"`s_span` must be two numbers (start, end), got {shown(s_span)}."
        ) from None


def checked_stops(save_at: Any, name: str = "save_at") -> list[float]:
    """Arclengths as floats; TypeError unless it is a series of numbers."""
    try:
        if isinstance(save_at, str | bytes):
            raise TypeError
        return [check_real(name, s) for s in save_at]
    except TypeError:
        raise TypeError(
            f"`{name}` must be a series of numbers, got {shown(save_at)}; a single "
            "arclength needs brackets too."
        ) from None


def check_number_of_steps(
    n_steps: float, span: float, ds: float, record_every: int
) -> None:
    """Raise ValueError if there are more steps or records than can be told apart."""
    if not n_steps <= MOST_STEPS:
        raise ValueError(
            f"`ds` must divide the span {span:g} into at most {MOST_STEPS:.2g} steps, "
            f"got {ds:g}; use a longer one."
        )
    if not n_steps / record_every <= MOST_RECORDS:
        raise ValueError(
            f"`record_every` must leave at most {MOST_RECORDS:g} records of "
            f"{n_steps:.3g} steps, got {record_every}; use a longer `ds`, or "
            f"record_every = {math.ceil(n_steps / MOST_RECORDS)}."
        )


def _step_of(s: float, start: float, ds: float, n_steps: int) -> int:
    if not math.isfinite(s):
        raise ValueError(f"`save_at` must hold finite numbers, got {s:g}.")
    # Far outside of the span the quotient may be infinite.
    step = round(min(max((s - start) / ds, -1.0), n_steps + 1.0))
    if not 0 <= step <= n_steps:
        first, last, got = told_apart(start, start + n_steps * ds, s)
        raise ValueError(
            f"`save_at` must lie in the span [{first}, {last}], got {got}."
        )
    if not same_arclength(start + step * ds, s, ds):
        got, nearest = told_apart(s, start + step * ds)
        raise ValueError(
            f"`save_at` must hold multiples of ds = {ds:.12g} from {start:g}, got "
            f"{got}; the nearest is {nearest}."
        )
    return step


def same_arclength(known: float, s: float, ds: float = math.inf) -> bool:
    """Whether s means the arclength `known`, among others that are ds apart.

    The one rule for what a caller types: what `save_at` takes for a step, `density`
    finds.
    """
    size = max(1.0, abs(known))
    tolerance = max(min(TYPED * size, OF_A_STEP * ds), ROUNDED * abs(known))
    return abs(known - s) <= tolerance


def index_of(known: NDArray[np.float64], s: float, ds: float = math.inf) -> int | None:
    """Which of some arclengths is s; None if none is.

    Parameters
    ----------
    known : ndarray, shape (n,)
    s : float
    ds : float
        Step of the run that they come from, where there is one.
    """
    # At infinity every number would be as near as the tolerance.
    if not (known.size and math.isfinite(s)):
        return None
    nearest = int(np.argmin(np.abs(known - s)))
    apart = float(np.min(np.diff(np.sort(known)), initial=ds))
    return nearest if same_arclength(float(known[nearest]), s, apart) else None


def saved_index(
    saved_s: NDArray[np.float64],
    s: float,
    ds: float = math.inf,
    remedy: str = "add it to `save_at` of the run",
) -> int:
    """Which of the saved arclengths is s; see `same_arclength`.

    Raises
    ------
    ValueError
        If none is.
    """
    s = check_real("s", s)
    found = index_of(saved_s, s, ds)
    if found is not None:
        return found
    *known, got = told_apart(*saved_s.tolist(), s)
    raise ValueError(
        f"`s` must be one of the saved values {', '.join(known) or 'none'}, got {got}; "
        f"{remedy}."
    )
