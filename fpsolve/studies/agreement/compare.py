"""A density that was computed against paths that were sampled."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.blas import one_blas_thread
from fpsolve._support.checks import check_integer, check_kind, check_real
from fpsolve.density.smooth.marginal import without_curvature
from fpsolve.density.solution import Solution
from fpsolve.density.steady_state import SteadyState
from fpsolve.studies.agreement.at_arclength import TESTS_PER_STATION, Station
from fpsolve.studies.agreement.check import CrossCheck
from fpsolve.studies.agreement.outcome import MARGINALS
from fpsolve.studies.agreement.reference import describe, model_of, places

if TYPE_CHECKING:
    from fpsolve.paths.result import Paths

__all__ = ["FEWEST_PATHS", "check_options", "compare"]

FEWEST_PATHS, FEWEST_CELLS = 1000, 8


@one_blas_thread()
def compare(
    density: Solution | SteadyState,
    paths: Paths,
    *,
    s: float | Iterable[float] | None = None,
    false_alarm: float = 1e-3,
    cells: int = 512,
    coarser: Sequence[Solution] = (),
) -> CrossCheck:
    """A density that was computed against paths that were sampled; see `cross_check`.

    Parameters
    ----------
    density : Solution or SteadyState
    paths : Paths
        Kept, or with a histogram on the grid of the density.
    s : float or iterable of float, optional
        By default all arclengths saved by both; with a `SteadyState` the last one.
    false_alarm : float
        Probability that any test fails when there is nothing to find, at most.
    cells : int
        Largest number of cells of phase space that are told apart.
    coarser : sequence of Solution, optional
        The same run on one or two grids, ever coarser. The error of the grid of
        `density`, estimated from the differences, is then allowed for in every test;
        without them that error counts as disagreement.

    Returns
    -------
    CrossCheck

    Raises
    ------
    ValueError
        If both have no s in common, or there are too few paths.
    """
    check_options(false_alarm, cells)
    grid, density = density.grid, without_curvature(density)
    from fpsolve.paths.result import Paths

    check_kind("paths", paths, Paths, "it is what `sample_paths` returns")
    check_integer("n_paths", paths.n_paths, at_least=FEWEST_PATHS)
    chosen = places(density, np.asarray(paths.s), s)
    size = false_alarm / (TESTS_PER_STATION * chosen.size)
    stations = [
        Station(density, paths, float(one), size, cells, coarser) for one in chosen
    ]
    return CrossCheck(
        model=model_of(density, paths),
        grid=grid,
        s=chosen,
        tests=tuple(test for station in stations for test in station.tests()),
        false_alarm=false_alarm,
        n_paths=paths.n_paths,
        solver={
            **describe(density),
            "coarser": [list(run.grid.shape) for run in coarser],
        },
        sampler=_describe_paths(paths),
        probabilities=_stacked([station.line_probabilities for station in stations]),
        counts=_stacked([station.line_counts for station in stations]),
    )


def _stacked(stations: list[dict[str, Any]]) -> dict[str, Any]:
    """Arrays over (s, cell) from one dictionary for every s."""
    return {which: np.array([one[which] for one in stations]) for which in MARGINALS}


def _describe_paths(paths: Paths) -> dict[str, Any]:
    return {
        "method": paths.method,
        "ds": float(paths.ds),
        "n_paths": paths.n_paths,
        "seed": paths.seed,
    }


def check_options(false_alarm: float, cells: int) -> None:
    """Raise unless the size of the tests and the number of cells make sense."""
    check_integer("cells", cells, at_least=FEWEST_CELLS)
    false_alarm = check_real("false_alarm", false_alarm)
    if not 0 < false_alarm < 1:
        raise ValueError(
            f"`false_alarm` must lie between 0 and 1, got {false_alarm:g}; it is the "
            "probability of a wrong alarm."
        )
