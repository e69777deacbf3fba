"""What a figure shows: a result of the right kind, and which arclengths of it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.checks import check_kind, shown
from fpsolve._support.declared import declared
from fpsolve.density.solution import Solution
from fpsolve.evolution.schedule import checked_stops
from fpsolve.model.potentials.dictionaries import potential_from_dict
from fpsolve.model.potentials.potential import Potential
from fpsolve.paths.result import Paths

if TYPE_CHECKING:
    import xarray as xr

    from fpsolve.reduced.hydrodynamic.solution import HydrodynamicSolution

__all__ = [
    "check_dataset",
    "check_datasets",
    "check_paths",
    "check_solution",
    "evenly",
    "potential_of",
    "select_s",
]


def evenly(count: int, at_most: int) -> list[int]:
    """Return at most so many places from first to last of `count`."""
    places = np.linspace(0, count - 1, min(count, at_most))
    return [int(place) for place in places.round()]


def select_s(
    solution: Solution | HydrodynamicSolution, at: Iterable[float] | None, at_most: int
) -> list[float]:
    """Return the arclengths to show: those asked for, or saved ones evenly thinned."""
    places = evenly(len(solution.saved_s), at_most)
    thinned = [float(solution.saved_s[place]) for place in places]
    chosen = thinned if at is None else checked_stops(at, "at")
    if not chosen:
        raise ValueError(
            "`solution` must hold a saved density to show, got none; name arclengths "
            "in `save_at` of the run."
        )
    return chosen


def potential_of(dataset: xr.Dataset) -> Potential | None:
    """Return the potential of a study; None if it was a user's own."""
    try:
        return potential_from_dict(declared(dataset.attrs)["potential"])
    except ValueError:
        return None


def check_solution(solution: Any) -> None:
    """Raise TypeError unless it is what `solve` returns."""
    check_kind("solution", solution, Solution, "it is what `solve` or `load` returns")


def check_paths(paths: Any) -> None:
    """Raise TypeError unless it is what `sample_paths` returns."""
    check_kind("paths", paths, Paths, "it is what `sample_paths` or `load` returns")


def check_dataset(name: str, dataset: Any) -> None:
    """Raise TypeError unless it is what a study returns."""
    import xarray as xr

    check_kind(name, dataset, xr.Dataset, "it is what a study returns")


def check_datasets(datasets: Any) -> list[Any]:
    """Return one dataset or several as a list; TypeError unless studies return them."""
    import xarray as xr

    if isinstance(datasets, xr.Dataset):
        return [datasets]
    listed = list(datasets) if isinstance(datasets, Iterable) else []
    if not listed or not all(isinstance(one, xr.Dataset) for one in listed):
        raise TypeError(
            f"`datasets` must be one Dataset or several, got {shown(datasets)}; they "
            "are what a study returns."
        )
    return listed
