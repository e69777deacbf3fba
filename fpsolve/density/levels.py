"""How many runs a run is: what `extrapolate` asks for, checked."""

from __future__ import annotations

from typing import Any

from fpsolve._support.checks import check_flag, check_integer, shown
from fpsolve.density.schemes.scheme import Scheme

__all__ = ["MOST_LEVELS", "check_even_powers", "checked_levels", "n_passes", "n_steps"]

# Weights of more levels are so large that they multiply rounding by a thousand.
MOST_LEVELS = 8


def checked_levels(scheme: Scheme, extrapolate: Any) -> bool | int:
    """What `extrapolate` says: False, True, or a number of levels from 2 to 8.

    Raises
    ------
    TypeError
        If it is neither.
    ValueError
        If there are too few levels or too many, or the scheme does not allow them.
    """
    if isinstance(extrapolate, int) and not isinstance(extrapolate, bool):
        levels = check_integer("extrapolate", extrapolate, at_least=0)
        if not 2 <= levels <= MOST_LEVELS:
            raise ValueError(
                f"`extrapolate` must be at least 2 and at most {MOST_LEVELS} levels, "
                f"got {levels}; False is a single run, True a second one with ds/2."
            )
        check_even_powers(scheme, f"`extrapolate` = {levels}")
        return levels
    try:
        return check_flag("extrapolate", extrapolate)
    except TypeError:
        raise TypeError(
            "`extrapolate` must be True or False, or a number of levels, got "
            f"{shown(extrapolate)}."
        ) from None


def check_even_powers(scheme: Scheme, asked: str) -> None:
    """Raise ValueError unless the scheme's error has even powers of ds only."""
    if getattr(scheme, "symmetric", False):
        return
    limited = bool(scheme.options.get("positive"))
    why = (
        "a limiter, whose error is no power of ds"
        if limited
        else "others, too, or does not say `symmetric`"
    )
    raise ValueError(
        f"{asked} needs a scheme whose error has even powers of ds only, got "
        f"{scheme.name}, which has {why}; use drift_kick(model, grid), or "
        "extrapolate=True."
    )


def n_passes(extrapolate: bool | int) -> int:
    """Runs with ds, ds/2, ds/3, …"""
    return 2 if extrapolate is True else max(1, int(extrapolate))


def n_steps(extrapolate: bool | int) -> int:
    """Steps of all of them for one of ds: 1 + 2 + …"""
    passes = n_passes(extrapolate)
    return passes * (passes + 1) // 2
