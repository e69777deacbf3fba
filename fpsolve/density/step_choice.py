"""The step of a run that is to reach a tolerance."""

from __future__ import annotations

from typing import Any

from fpsolve.density.levels import check_even_powers
from fpsolve.density.schemes.scheme import Scheme
from fpsolve.density.suggestions import check_tolerance, suggest_step
from fpsolve.evolution.schedule import checked_span, step_dividing

__all__ = ["chosen_step"]

# Error of the first and longest step: levels bring it down by orders, and begin to
# converge from about there on.
FIRST_ERROR = 0.1
# Steps that are shorter by this are not looked for.
SHORTER = 100


def chosen_step(
    scheme: Scheme,
    s_span: Any,
    save_at: tuple[float, ...] | None,
    ds: float | None,
    extrapolate: bool | int,
    tolerance: float | None,
) -> float:
    """The step that was given, or the longest to begin with for a tolerance.

    Raises
    ------
    TypeError
        If there is neither a step nor a tolerance.
    ValueError
        If a tolerance is none, or the scheme or `extrapolate` does not go with one, or
        no step divides the stops.
    """
    if tolerance is None:
        if ds is None:
            raise TypeError(
                "`ds` must be given where `tolerance` is not; `suggest_step` proposes "
                "one."
            )
        return ds
    check_tolerance(tolerance)
    check_even_powers(scheme, f"`tolerance` = {tolerance:g}")
    if scheme.options.get("translation") != "fourier":
        raise ValueError(
            f"`tolerance` = {tolerance:g} needs a scheme that tells what its cells "
            f"leave, got {scheme.name} with piecewise interpolation; use "
            'drift_kick(model, grid, translation="fourier"), or choose `ds` and '
            "`extrapolate`."
        )
    if extrapolate is not False:
        raise ValueError(
            f"`extrapolate` must be left out with `tolerance`, got {extrapolate}: "
            "the number of levels follows from the tolerance."
        )
    return _longest(scheme, s_span, save_at) if ds is None else ds


def _longest(scheme: Scheme, s_span: Any, save_at: tuple[float, ...] | None) -> float:
    start, end = checked_span(s_span)
    longest = float(suggest_step(scheme.model, scheme.grid, FIRST_ERROR))
    stops = [s - start for s in sorted({*(save_at or ()), end})]
    # What is no span or no stop in it is told when the schedule is made.
    if not (end > start and stops[0] >= 0.0 and stops[-1] == end - start):
        return longest
    ds = step_dividing(stops, min(longest, end - start), SHORTER)
    if ds is None:
        raise ValueError(
            "`save_at` must hold multiples of a step that can be found, got none for "
            f"{save_at}; give `ds`."
        )
    return ds
