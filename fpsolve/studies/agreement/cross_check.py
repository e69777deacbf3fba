"""Density against paths: the same model answered twice, independently."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from fpsolve._support.arrays import Array, check_numbers
from fpsolve._support.checks import check_integer
from fpsolve._support.progress import ProgressCallback
from fpsolve.density.schemes import drift_kick
from fpsolve.density.schemes.dictionaries import described_scheme
from fpsolve.density.schemes.scheme import Scheme
from fpsolve.density.smooth.marginal import without_curvature
from fpsolve.density.smooth.smooth_drift_kick import SmoothDriftKick
from fpsolve.density.solution import Solution
from fpsolve.density.solve import solve
from fpsolve.errors import ToleranceError
from fpsolve.evolution.call import recorded
from fpsolve.grids.initial import with_curvature
from fpsolve.grids.smooth import AnyGrid, SmoothPhaseSpaceGrid, check_smooth_grid
from fpsolve.model.fibre import FibreModel
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.studies.agreement.check import CrossCheck
from fpsolve.studies.agreement.coarser import (
    coarser_runs,
    start_noncentrality,
    within_error,
)
from fpsolve.studies.agreement.compare import FEWEST_PATHS, check_options, compare
from fpsolve.studies.agreement.reference import reference_at
from fpsolve.studies.agreement.steps import paths_step, solver_step
from fpsolve.studies.starts import density_and_law

if TYPE_CHECKING:
    from fpsolve.paths.laws import DensityLaw

__all__ = ["cross_check"]

# Beyond this L1 error of the grid a test would allow for whatever it finds.
MOST_GRID_ERROR = 0.1
# What different starts may add to the χ² of a test: a share of its scatter, which is 8
# with 32 degrees of freedom and 32 with 512.
MOST_NONCENTRALITY = 1.0
RECORD_EVERY = 8


@recorded(scheme=described_scheme)
def cross_check(
    model: FibreModel,
    p0: Any,
    s: float | Iterable[float],
    *,
    grid: AnyGrid | None = None,
    n_paths: int = 1_000_000,
    seed: int,
    ds: float | None = None,
    paths_ds: float | None = None,
    scheme: Scheme | None = None,
    method: str = "splitting",
    false_alarm: float = 1e-3,
    cells: int = 512,
    extrapolate: bool = True,
    solve_options: Mapping[str, Any] | None = None,
    client: Any = None,
    progress: bool | ProgressCallback = False,
) -> CrossCheck:
    """Density of (7) against paths of (6): do both give the same law at every s?

    Of a smooth fibre the density of (23) and paths of (22), which begin with the
    curvature of a free fibre; compared are position and angle.

    Solves for the density, samples paths from the same start, and tests at every s
    the counts of paths in cells of phase space against the integrals of the density
    over them (χ², and the largest single cell), the marginals of ξ1, ξ2 and α (χ²),
    and the moments in standard errors. Memory does not grow with the number of paths.
    Two more runs on coarser grids estimate the error of the grid, for which every test
    allows.

    Parameters
    ----------
    model : LayDownModel or SmoothLayDownModel
    p0 : ndarray, shape grid.shape, or GaussianLaw, EquilibriumLaw, DensityLaw
        Start of both: a density of (ξ, α) on the grid, or a law of `fpsolve.paths`.
    s : float or iterable of float
        Arclengths at which to compare.
    grid : PhaseSpaceGrid or SmoothPhaseSpaceGrid
        May be left out with a scheme or a DensityLaw, which have one.
    n_paths : int
        Standard errors fall like 1/√n_paths.
    seed : int
        Of the paths; the same seed gives the same result.
    ds : float, optional
        Step of the density; by default its L1 error is 1/√n_paths even before
        extrapolation.
    paths_ds : float, optional
        Step of the paths; by default ds/2, or less until the estimated bias is a tenth
        of the standard errors.
    scheme : Scheme, optional
        By default `drift_kick`, balanced if p0 allows it.
    method : str
        Of the paths; see `sample_paths`.
    false_alarm : float
        Probability that any test fails when there is nothing to find, at most.
    cells : int
        Largest number of cells of phase space that are told apart; fewer see smaller
        differences of large scale.
    extrapolate : bool
        Richardson extrapolation of the density, which also estimates step errors.
    solve_options : mapping, optional
        Further options of `solve`, for instance its tolerances.
    client : object, optional
        Runs the paths; see `sample_paths`.
    progress : bool or callable
        As in `solve`; for the density, then for the paths.

    Returns
    -------
    CrossCheck
        Print it for the verdict.

    Raises
    ------
    ValueError, TypeError
        For arguments that do not fit each other; besides whatever `solve` and
        `sample_paths` raise.
    ToleranceError
        If the error of the grid is more than a tenth in L1, so that nothing could be
        learned, or if a density on the grid is so steep that the paths would see that
        it is sampled by interpolation.

    References
    ----------
    [KMW09]_, equations (6) and (7).
    """
    from fpsolve.paths.laws import DensityLaw
    from fpsolve.paths.sampling import sample_paths

    s = _checked_places(s)
    n_paths = check_integer("n_paths", n_paths, at_least=FEWEST_PATHS)
    check_options(false_alarm, cells)
    grid = _grid_of(grid, scheme, p0)
    plain = grid.phase_space if isinstance(grid, SmoothPhaseSpaceGrid) else grid
    p0, law = density_and_law(p0, plain)
    if isinstance(law, DensityLaw):
        _check_start(law, n_paths)
    if isinstance(model, SmoothLayDownModel):
        check_smooth_grid(grid)
        p0 = with_curvature(p0, cast(Any, grid), model.curvature_variance)
    scheme = _scheme_for(model, grid, p0) if scheme is None else scheme
    _check_scheme(scheme, model, grid)
    if ds is None:
        ds = solver_step(cast(Any, model), cast(Any, grid), s, n_paths)
    ds = float(ds)
    solution = solve(
        scheme, p0, (0.0, float(s[-1])), ds,
        save_at=s.tolist(), extrapolate=extrapolate, progress=progress,
        **{"record_every": RECORD_EVERY, **(solve_options or {})},
    )  # fmt: skip
    solution = without_curvature(solution)
    coarser = coarser_runs(solution, scheme, law, solve_options)
    _check_resolved(solution, coarser, s)
    if paths_ds is None:
        paths_ds = _paths_step(solution, s, n_paths)
    paths = sample_paths(
        model, n_paths, float(s[-1]), paths_ds,
        seed=seed, initial=law, save_at=s.tolist(), method=method,
        histogram=plain, keep=False, client=client, progress=progress,
    )  # fmt: skip
    check = compare(
        solution, paths, s=s, false_alarm=false_alarm, cells=cells,
        coarser=() if isinstance(coarser, str) else coarser,
    )  # fmt: skip
    check = replace(check, grid=grid)
    if isinstance(coarser, str):
        check = replace(check, solver={**check.solver, "coarser": coarser})
    return check


def _checked_places(s: float | Iterable[float]) -> Array:
    """Arclengths, ascending and each once."""
    several = isinstance(s, Iterable) and not isinstance(s, str | bytes)
    chosen = np.unique(check_numbers("s", list(cast(Any, s)) if several else [s]))
    if not (chosen.size and np.all(np.isfinite(chosen)) and chosen[0] >= 0):
        raise ValueError(f"`s` must be one or more non-negative arclengths, got {s!r}.")
    if not chosen[-1] > 0:
        raise ValueError("`s` must hold a positive arclength, got 0; nothing evolves.")
    return chosen


def _grid_of(grid: Any, scheme: Scheme | None, p0: Any) -> Any:
    for owner in (scheme, p0):
        known = getattr(owner, "grid", None)
        if grid is None and isinstance(known, AnyGrid):
            grid = known
    if grid is None:
        raise TypeError(
            "`grid` must be given unless `scheme` or `p0` has one; pass a "
            "PhaseSpaceGrid, `suggest_grid(model)` proposes one."
        )
    return grid


def _check_scheme(scheme: Scheme, model: FibreModel, grid: AnyGrid) -> None:
    if scheme.model != model:
        raise ValueError(
            f"`scheme` must solve the model that is checked, got one for\n"
            f"{scheme.model!r}; to compare two models, use `compare`."
        )
    if scheme.grid != grid:
        raise ValueError(
            f"`grid` must be that of the scheme, {scheme.grid}, got {grid}; leave it "
            "out."
        )


def _scheme_for(model: Any, grid: Any, p0: Array) -> Any:
    """drift_kick, balanced where the density stays within reach of e^{−B}."""
    if isinstance(model, SmoothLayDownModel):
        return SmoothDriftKick(model, grid)
    if model.potential.normalisable:
        balanced = drift_kick(model, grid, balanced=True)
        try:
            balanced.start(p0)
        except ValueError:
            # The start does not fall off like e^{−B}: p itself is evolved then.
            pass
        else:
            return balanced
    return drift_kick(model, grid)


def _check_start(law: DensityLaw, n_paths: int) -> None:
    """Raise ToleranceError where paths and the run begin visibly differently."""
    worst, distance = start_noncentrality(law)
    most = MOST_NONCENTRALITY / max(worst, 1e-300)
    if not n_paths <= most:
        cells = " x ".join(map(str, law.grid.shape))
        raise ToleranceError(
            distance, distance * math.sqrt(most / n_paths),
            f"by that `p0` on {cells} cells differs in L1 from the law that paths "
            f"begin with, which {most:.2g} paths do not see and {n_paths} would; "
            "refine the grid, smooth `p0`, or give a GaussianLaw",
        )  # fmt: skip


def _check_resolved(
    solution: Solution, coarser: tuple[Solution, ...] | str, s: Array
) -> None:
    """Raise ToleranceError where the grid's error leaves nothing to compare."""
    if isinstance(coarser, str):
        return
    grid = solution.grid
    for one in s:
        p = solution.density(float(one))
        error = within_error(p, grid, float(one), coarser).distance
        if not error <= MOST_GRID_ERROR:
            cells = " x ".join(map(str, grid.shape))
            raise ToleranceError(
                error, MOST_GRID_ERROR,
                f"that is the L1 error of {cells} cells at s = {one:g}, which hides "
                "what paths could show; refine the grid",
            )  # fmt: skip


def _paths_step(solution: Solution, s: Array, n_paths: int) -> float:
    """The longest step of the paths that is short enough at every s."""
    references = [reference_at(solution, float(one)) for one in s if one > 0]
    return min(
        paths_step(solution.ds, one.moments, one.errors, n_paths) for one in references
    )
