"""Repeat a result of any kind."""

from __future__ import annotations

import warnings
from typing import Any

from fpsolve.errors import NotRepeatableError, RunError
from fpsolve.results.load import opened
from fpsolve.results.rerun.calls import repeat_call

__all__ = ["rerun"]


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
        return repeat_call(result, overrides)
    except RunError as error:
        if getattr(result, "status", "") == "failed" and error.solution is not None:
            return error.solution
        raise
