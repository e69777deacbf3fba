"""Repeat a result of any kind."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from fpsolve._support.netcdf import read_dataset, reported_damage
from fpsolve.errors import NotRepeatableError, RunError
from fpsolve.results.kinds import from_xarray, kind_of
from fpsolve.results.rerun.limits import repeat_energy, repeat_hydrodynamic
from fpsolve.results.rerun.paths import repeat_paths
from fpsolve.results.rerun.solutions import repeat_solution
from fpsolve.results.rerun.studies import repeat_check, repeat_study

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["rerun"]

_REPEATERS: dict[str, Callable[[Any, dict[str, Any]], Any]] = {
    "solution": repeat_solution,
    "paths": repeat_paths,
    "hydrodynamic": repeat_hydrodynamic,
    "energy": repeat_energy,
}
# What a damaged or tampered file makes those raise who read what is in it.
_DAMAGE = (KeyError, IndexError, TypeError, ValueError)


def rerun(result: Any, **overrides: Any) -> Any:
    """Compute a result again, with the arguments that it was computed with.

    On the same machine with the same versions the new result has the same bits,
    whatever the numbers of threads and processes; `compare` says so. Of a run that was
    interrupted the whole is computed. A run that had failed fails again: the partial
    result is returned.

    Parameters
    ----------
    result : path, Solution, Paths, HydrodynamicSolution, EnergySolution, CrossCheck \
or xarray.Dataset
        A file, a result, or the dataset of a study.
    **overrides
        Arguments to change, by the names that they have in the function that made it:
        `solve`, `sample_paths`, the `solve` of a limit, or a study; for instance
        ``ds=0.1``, ``model=model`` for a file whose potential was your own code, or
        ``progress=True``.

    Returns
    -------
    Solution, Paths, HydrodynamicSolution, EnergySolution, CrossCheck or xarray.Dataset
        The same as was given; of a file what `load` gives, and of a study its Dataset.

    Raises
    ------
    FileNotFoundError, FileFormatError
        If the file does not exist or is damaged.
    NotRepeatableError
        If it does not say how it was made, was made with a user's own code that is
        not given, or asks for more steps, paths or cases than it holds.
    """
    if isinstance(result, (str, os.PathLike)):
        dataset = read_dataset(result)
        with reported_damage(result, *_DAMAGE):
            result = _loaded(dataset)
    return _repeat(result, overrides)


def _loaded(dataset: xr.Dataset) -> Any:
    """Return the result in a dataset, a study as it is."""
    if "fpsolve_format" not in dataset.attrs:
        return dataset
    with warnings.catch_warnings():
        # If the model is missing, the error below says what to do about it.
        warnings.simplefilter("ignore", UserWarning)
        return from_xarray(dataset)


def _repeat(result: Any, overrides: dict[str, Any]) -> Any:
    import xarray as xr

    from fpsolve.studies.agreement.check import CrossCheck

    if isinstance(result, CrossCheck):
        return repeat_check(result, overrides)
    if isinstance(result, xr.Dataset):
        if "fpsolve_format" not in result.attrs:
            return repeat_study(result, overrides)
        result = _loaded(result)
    kind = _kind_of(result)
    try:
        return _REPEATERS[kind](result, overrides)
    except RunError as error:
        if getattr(result, "status", "") == "failed" and error.solution is not None:
            return error.solution
        raise


def _kind_of(result: Any) -> str:
    try:
        return kind_of(result)
    except TypeError:
        raise NotRepeatableError(
            "`result` must be a file, a solution, paths, or the dataset of a study, "
            f"got {type(result).__name__}; call its function again."
        ) from None
