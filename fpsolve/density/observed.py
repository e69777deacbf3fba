"""Numbers of the caller's own, recorded at every step beside those of every run."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import fields
from typing import Any, TypeAlias

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_call, shown
from fpsolve.density.solution import Solution
from fpsolve.errors import ObservationError
from fpsolve.evolution.call import IDENTITY, USER_CODE
from fpsolve.evolution.series import COORDINATES, SERIES, START, Series
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.identity.digests import digest_or_none

__all__ = ["Observe", "described_observed", "observed_series"]

# A name, and what gives a number for a density on a grid.
Observe: TypeAlias = Mapping[str, Callable[[Array, PhaseSpaceGrid], Any]]

_TAKEN = {"density", *SERIES, *COORDINATES, *START, *(f.name for f in fields(Solution))}


def observed_series(observe: Observe | None) -> tuple[Series, ...]:
    """The series of `observe`, each checked for its name and its kind.

    Raises
    ------
    TypeError
        If it is no mapping of names to functions.
    ValueError
        If a name is none that a solution can have.
    """
    if observe is None:
        return ()
    if not isinstance(observe, Mapping):
        raise TypeError(
            f"`observe` must be a mapping of names to functions, got {shown(observe)}; "
            "write observe={'returning': returning}."
        )
    for name, function in observe.items():
        _check_name(name)
        check_call(f"observe[{name!r}]", function, "f(p, grid)")
    return tuple(_series(name, function) for name, function in observe.items())


def described_observed(observe: Observe | None, kept: bool) -> dict[str, Any] | None:
    """What the call of a run says of `observe`: a digest of each function.

    Parameters
    ----------
    observe : mapping or None
    kept : bool
        Whether the run is kept in a checkpoint, which has to tell the functions apart.

    Raises
    ------
    ValueError
        If they cannot be told apart.
    """
    if not observe:
        return None
    digests = {name: digest_or_none(one) for name, one in observe.items()}
    unknown = [name for name, digest in digests.items() if digest is None]
    if kept and unknown:
        raise ValueError(
            f"`observe[{unknown[0]!r}]` must be told from others by code and data to "
            "be kept in a checkpoint; leave out `checkpoint`, or what has neither."
        )
    return {name: {USER_CODE: name, IDENTITY: one} for name, one in digests.items()}


def _check_name(name: Any) -> None:
    usable = isinstance(name, str) and name.isidentifier() and name[0] != "_"
    if not usable or name.endswith("_error") or _is_taken(name):
        raise ValueError(
            f"`observe` must have names that are free, got {name!r}; take a word that "
            "no solution has as an attribute."
        )


def _is_taken(name: str) -> bool:
    return name in _TAKEN or hasattr(Solution, name)


def _series(name: str, function: Callable[[Array, PhaseSpaceGrid], Any]) -> Series:
    def value(record: Any) -> float:
        # A user's function raises whatever it likes, and the run is to be kept.
        try:
            found = np.asarray(function(_read_only(record.p), record.grid))
            if found.shape != () or found.dtype.kind not in "biuf":
                raise TypeError(f"it gives {shown(found)} and no number")
            number = float(found)
        except Exception as error:
            reason = " ".join(str(error).split()) or type(error).__name__
            raise ObservationError(name, record.s, reason) from error
        if not math.isfinite(number):
            raise ObservationError(name, record.s, f"it gives {number:g}")
        return number

    return Series(name, f"{name}, observed", value)


def _read_only(p: Array) -> Array:
    """The density as something that cannot be written to: the run goes on with it."""
    view = p.view()
    view.flags.writeable = False
    return view
