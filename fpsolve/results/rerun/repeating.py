"""Repeat a result of any kind: it says how it was called."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import Any

from fpsolve.errors import NotRepeatableError, RunError
from fpsolve.evolution.call import Call
from fpsolve.results.kinds import KINDS, kind_of
from fpsolve.results.load import opened
from fpsolve.results.rerun.arguments import arguments_of, unrecorded
from fpsolve.results.rerun.calling import called, name_of
from fpsolve.results.rerun.costs import check_call

__all__ = ["rerun"]

# What the command line adds.
_NOTES = ("command", "configuration", "suggested")


def rerun(result: Any, **overrides: Any) -> Any:
    """Compute a result again, with the arguments that it was computed with.

    On the same machine with the same versions the new result has the same bits,
    whatever the numbers of threads and processes; `compare` says so. Of a run that was
    interrupted the whole is computed. A run that had failed fails again: the partial
    result is returned.

    Parameters
    ----------
    result : path or result
        A file, a result of any kind, or its dataset; a study is one.
    **overrides
        Arguments to change, by the names that they have in the function that made it,
        or in the class whose method it is; for instance ``ds=0.1``, ``model=model``
        for a file whose potential was your own code, or ``progress=True``.

    Returns
    -------
    object
        The same as was given; of a file what `load` gives, and of a study its Dataset.

    Raises
    ------
    FileNotFoundError, FileFormatError
        If the file does not exist or is damaged.
    NotRepeatableError
        If it does not say how it was made, was made with a user's own code that is
        not given, or asks for more steps, paths or cases than it holds.
    """
    try:
        with warnings.catch_warnings():
            # If the model is missing, the error below says what to do about it.
            warnings.simplefilter("ignore", UserWarning)
            result = opened(result)
    except TypeError as error:
        raise NotRepeatableError(f"{error} Call its function again.") from None
    try:
        return _repeated(result, overrides)
    except RunError as error:
        if getattr(result, "status", "") == "failed" and error.solution is not None:
            return error.solution
        raise


def _repeated(result: Any, overrides: dict[str, Any]) -> Any:
    """Call the function of a result as it was called, with the overrides."""
    place = KINDS[kind_of(result)].function
    name = name_of(place)
    call = _call_of(result)
    if call is None:
        raise unrecorded("how it was computed", f"`{name}`")
    if call.function != name:
        raise NotRepeatableError(
            f"the result must be made by {name} to be repeated, got "
            f"{call.function!r}; update fpsolve."
        )
    arguments = arguments_of(call, overrides, result)
    check_call(name, arguments, result, overrides)
    return _noted(result, called(place, arguments, overrides), call)


def _call_of(result: Any) -> Call | None:
    if hasattr(result, "data_vars"):
        return Call.from_xarray(result)
    call: Call | None = result.call
    return call


def _noted(old: Any, new: Any, call: Call) -> Any:
    """The new result, if of the same call with what a command wrote beside it."""
    again = _call_of(new)
    if again is None or again.arguments != call.arguments:
        return new
    if hasattr(old, "data_vars"):
        return new.assign_attrs({n: old.attrs[n] for n in _NOTES if n in old.attrs})
    notes = {n: old.provenance[n] for n in _NOTES if n in old.provenance}
    return replace(new, provenance={**new.provenance, **notes}) if notes else new
