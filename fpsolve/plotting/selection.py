"""Which saved arclengths a figure shows."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.checks import check_kind, shown
from fpsolve.density.solution import Solution
from fpsolve.evolution.schedule import checked_stops
from fpsolve.paths.result import Paths

if TYPE_CHECKING:
    from fpsolve.reduced.hydrodynamic.solution import HydrodynamicSolution

__all__ = [
    "check_dataset",
    "check_datasets",
    "check_energy_solution",
    "check_hydrodynamic_solution",
    "check_paths",
    "check_process",
    "check_solution",
    "check_spectrum",
    "select_s",
]


def select_s(
    solution: Solution | HydrodynamicSolution, at: Iterable[float] | None, at_most: int
) -> list[float]:
    """Return the arclengths to show: those asked for, or saved ones evenly thinned."""
    if at is not None:
        chosen = checked_stops(at, "at")
    else:
        n_saved = len(solution.saved_s)
        steps = np.linspace(0, n_saved - 1, min(n_saved, at_most)).round().astype(int)
        chosen = [float(s) for s in solution.saved_s[steps]]
    if not chosen:
        raise ValueError(
            "`solution` must hold a saved density to show, got none; name arclengths "
            "in `save_at` of the run."
        )
    return chosen


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


def check_process(process: Any) -> None:
    """Raise TypeError unless it is an energy process."""
    from fpsolve.reduced.energy.process import EnergyProcess

    check_kind("process", process, EnergyProcess, "EnergyProcess(potential, noise)")


def check_energy_solution(solution: Any) -> None:
    """Raise TypeError unless it is a law of the energy."""
    from fpsolve.reduced.energy.solution import EnergySolution

    check_kind("solution", solution, EnergySolution, "see EnergyProcess.solve")


def check_hydrodynamic_solution(solution: Any) -> None:
    """Raise TypeError unless it is a solution of the hydrodynamic limit."""
    from fpsolve.reduced.hydrodynamic.solution import HydrodynamicSolution

    check_kind(
        "solution", solution, HydrodynamicSolution, "see HydrodynamicLimit.solve"
    )


def check_spectrum(found: Any) -> None:
    """Raise TypeError unless it is a spectrum of the generator."""
    from fpsolve.spectral.eigen.spectrum import Spectrum

    check_kind("found", found, Spectrum, "it is what `spectrum` returns")
