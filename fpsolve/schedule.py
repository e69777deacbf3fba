"""Steps of a run: when to record, when to save."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._checks import check_integer, check_real, shown

__all__ = ["Schedule", "make_schedule", "saved_index"]

# Steps and saving points must fit the span to this many steps.
FIT = 1e-6
# How far a saved arclength may be from the one asked for, relative.
SAME = 1e-9
# Beyond this many steps s = start + n ds is no longer a different number for each n.
MOST_STEPS = 2**53
# Each takes about two kilobytes.
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

    def legs(self) -> Iterator[tuple[int, int]]:
        """Pairs (from, to) of neighbouring records."""
        return zip(self.records[:-1], self.records[1:], strict=True)

    def refined(self) -> Schedule:
        """The same stops with half the step."""
        return Schedule(
            self.start,
            self.ds / 2,
            2 * self.n_steps,
            tuple(2 * step for step in self.records),
            tuple(2 * step for step in self.saves),
        )


def make_schedule(
    s_span: tuple[float, float],
    ds: float,
    save_at: Iterable[float] | None = None,
    record_every: int = 1,
) -> Schedule:
    """Steps of a run over `s_span`, checked.

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
    if n_steps < 1 or abs(n_steps * ds - (end - start)) > FIT * ds * max(n_steps, 1):
        n_better = max(1, math.ceil((end - start) / ds - FIT))
        raise ValueError(
            f"`ds` must divide the span {end - start:g} into whole steps, got {ds:g}; "
            f"use ds = {(end - start) / n_better:.12g}."
        )
    ds = (end - start) / n_steps
    stops = (end,) if save_at is None else checked_stops(save_at)
    saves = tuple(sorted({_step_of(s, start, ds, n_steps) for s in stops}))
    records = sorted({*range(0, n_steps, record_every), n_steps, *saves})
    return Schedule(start, ds, n_steps, tuple(records), saves)


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
    step = round((s - start) / ds)
    if not 0 <= step <= n_steps:
        raise ValueError(
            f"`save_at` must lie in the span [{start:g}, {start + n_steps * ds:g}], "
            f"got {s:g}."
        )
    if abs(start + step * ds - s) > FIT * max(1, n_steps) * ds:
        raise ValueError(
            f"`save_at` must hold multiples of ds = {ds:g} from {start:g}, got {s:g}; "
            f"the nearest is {start + step * ds:g}."
        )
    return step


def saved_index(saved_s: NDArray[np.float64], s: float) -> int:
    """Which of the saved arclengths is s.

    Raises
    ------
    ValueError
        If none is, to a relative 1e-9.
    """
    s = check_real("s", s)
    # At infinity every number would be as near as the tolerance.
    if saved_s.size and math.isfinite(s):
        nearest = int(np.argmin(np.abs(saved_s - s)))
        if abs(saved_s[nearest] - s) <= SAME * max(1.0, abs(s)):
            return nearest
    known = ", ".join(f"{value:g}" for value in saved_s) or "none"
    raise ValueError(
        f"`s` must be one of the saved values {known}, got {s:g}; "
        "add it to `save_at` of the run."
    )
