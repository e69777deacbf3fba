"""Densities under rotating and oscillating nozzles, which come back every period."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.blas import one_blas_thread
from fpsolve._support.checks import check_integer, check_kind, check_tolerance
from fpsolve._support.memory import check_memory, required_memory
from fpsolve.density.periodic.period import (
    check_periodic,
    on_mean_belt,
    steps_and_length,
)
from fpsolve.density.periodic.phases import Phases, at_phases
from fpsolve.density.periodic.refinement import Refined, refined
from fpsolve.density.periodic.result import PeriodicState
from fpsolve.density.smooth.lag import curvature_lag
from fpsolve.density.stationary.coarser import carried
from fpsolve.density.stationary.estimates import (
    DENSITY,
    box_error,
    field_error,
    total,
)
from fpsolve.density.stationary.iteration import Stationary, settled
from fpsolve.density.stationary.remedies import WORTHLESS, check_error, remedy
from fpsolve.density.stationary.requirements import checked_step
from fpsolve.density.stationary.start import start_on
from fpsolve.density.steady_state import (
    DIRECTIONS,
    STEP_SHARE,
    first_step,
    scheme_for,
)
from fpsolve.errors import CurvatureRangeError, DomainTooSmallError, ToleranceError
from fpsolve.evolution.call import recorded
from fpsolve.grids import diagnostics
from fpsolve.grids.smooth import AnyGrid, SmoothPhaseSpaceGrid
from fpsolve.grids.smooth_sums import SmoothFunctionals
from fpsolve.model.fibre import FibreModel
from fpsolve.model.smooth import SmoothLayDownModel

__all__ = ["PeriodicState", "periodic_state"]

# Phases at least, and copies of each that are alive on the finest grid: three runs,
# their combinations, errors, and the coarser grids.
FEWEST_PHASES, ALIVE = 4, 10
# Weights of the translations, which every period needs again, in bytes at most.
LARGEST_TAPS = 2.0**27


@recorded()
@one_blas_thread()
def periodic_state(
    model: FibreModel,
    grid: AnyGrid,
    *,
    ds: float | None = None,
    tolerance: float = 1e-9,
    n_phases: int = 32,
    boundary_tolerance: float = 1e-3,
    error_tolerance: float = 1e-3,
) -> PeriodicState:
    """Density p(ξ, α; s) = p(ξ, α; s + P) under a nozzle of period P, with its error.

    The fixed point of the evolution over whole periods P = 2π/|ω| (at least about a
    unit of arclength), of the palindrome `drift_kick(..., interpolation_order=12)` or
    `smooth_drift_kick`, extrapolated from three step lengths (the composition is
    symmetric for a moving γ too, so that the error has even powers of ds only): found
    as by `steady_state` by a recycled Krylov iteration on half of the cells, three
    quarters, and all. From it the other phases follow by evolution. Conserved: mass,
    to rounding. Not kept: the sign; negative values are of the size of the error.
    Steps are shortened until their error is a fifth of `error_tolerance`; the cells
    and the box are as given, so that their errors can only be estimated: compare
    `errors`.

    Exact for every potential: d(E ξ)/ds = E τ − γ′, so that E τ is γ′ on average over
    the period.

    Parameters
    ----------
    model : LayDownModel or SmoothLayDownModel
        With a nozzle, or a curve of your own that names its `period` P, with
        γ(s + P) = γ(s) − v P e₁.
    grid : PhaseSpaceGrid or SmoothPhaseSpaceGrid
        The box must hold ξ = η − γ at every phase: under a nozzle that moves faster
        than it is followed its radius comes on top of the throwing range.
    ds : float, optional
        The longest step to begin with.
    tolerance : float
        Residual to reach.
    n_phases : int
        Phases at which the density is kept, at least 4.
    boundary_tolerance : float
        Largest share of mass in the outermost cells, at every phase.
    error_tolerance : float
        Error in L1 above which the result comes with a warning.

    Raises
    ------
    ValueError
        If the curve does not move periodically, the potential does not confine, there
        is no noise, or a linear potential is too weak for the belt; for fewer than 6
        cells in a direction.
    SteadyStateError
        If the residual stays above `tolerance`.
    DomainTooSmallError, CurvatureRangeError
        If the box cuts the density off, or the range of the curvature.
    MemoryLimitError
        If the phases need more memory than there is.
    ToleranceError
        If the error is estimated above 0.1 (and above `error_tolerance`).

    Warns
    -----
    UserWarning
        If the error is estimated above `error_tolerance`.

    References
    ----------
    [KMW09]_, section 4.2, for the reference curves.
    """
    remedy_text = "make one by LayDownModel(potential, noise, curve)"
    check_kind("model", model, FibreModel, remedy_text)
    period = check_periodic(model)
    n_phases = int(check_integer("n_phases", n_phases, FEWEST_PHASES))
    first = None if ds is None else checked_step(ds)
    tolerance = check_tolerance("tolerance", tolerance)
    error_tolerance = check_tolerance("error_tolerance", error_tolerance)
    boundary_tolerance = check_tolerance("boundary_tolerance", boundary_tolerance)
    scheme = scheme_for(model, grid)
    check_memory(required_memory(grid.nbytes, DIRECTIONS + ALIVE * n_phases, 0))
    step, length = steps_and_length(period, first or first_step(scheme))
    goal = STEP_SHARE * min(error_tolerance, WORTHLESS)

    def solver(here: Any, start: Array | None, ds: float) -> Stationary:
        remember_translations(here)
        residual = tolerance if here.grid == grid else math.inf
        if start is None:
            start = start_on(here.grid, on_mean_belt(model))
        return settled(
            here, ds, carried(start, here.grid.shape), goal, residual, length
        )

    def reader(here: Any, found: Stationary) -> Phases:
        return at_phases(here, found, period, n_phases)

    found = refined(scheme, step, solver, reader)
    result = with_errors(scheme, found, period)
    check_boundary(result, boundary_tolerance, error_tolerance, found.order)
    told = partial(advice, result, error_tolerance, found.order)
    check_error("periodic", result, error_tolerance, told)
    return result


def remember_translations(scheme: Any) -> None:
    """Let the scheme keep the weights of all translations of a period."""
    translate, cells = scheme.translate, math.prod(scheme.grid.shape[2:])
    each = 2.0 * cells * (translate.order + 1) * np.dtype(np.float64).itemsize
    translate.kept = max(translate.kept, int(LARGEST_TAPS / each))


def with_errors(scheme: Any, found: Refined, period: float) -> PeriodicState:
    """The densities on the finest grid with all parts of their errors."""
    n = len(found.phases.densities)
    each = [errors_at(scheme, found, j) for j in range(n)]
    sums = [total(parts) for parts in each]
    names = [name for name in sums[0] if name != DENSITY]
    return PeriodicState(
        s=np.arange(n, dtype=np.float64) * (period / n),
        densities=found.phases.densities,
        period=period,
        residual=found.first.residual,
        grid=scheme.grid,
        ds=found.first.ds,
        n_applications=found.n_applications,
        phase_errors=np.array([one[DENSITY] for one in sums]),
        plane_errors=on_the_plane(scheme.grid, found),
        errors={part: max(parts[part][DENSITY] for parts in each) for part in each[0]},
        moment_errors={name: np.array([one[name] for one in sums]) for name in names},
        model=scheme.model,
    )


def on_the_plane(grid: Any, found: Refined) -> Array:
    """∫ dα (and dκ) of the fields like errors of step, grid and iteration."""
    fields = (found.phases.step, found.grid_error, found.phases.iteration)
    width = math.prod(grid.spacing[2:])
    axes = tuple(range(3, 1 + len(grid.shape)))
    return np.stack([field.sum(axis=axes) * width for field in fields])


def errors_at(scheme: Any, found: Refined, j: int) -> dict[str, Mapping[str, float]]:
    """The parts of the error at one phase."""
    p, grid = found.phases.densities[j], scheme.grid
    parts: dict[str, Mapping[str, float]] = {
        "step": field_error(found.phases.step[j], p, grid),
        "grid": field_error(found.grid_error[j], p, grid),
        "box": box_error(p, grid),
        "iteration": field_error(found.phases.iteration[j], p, grid),
    }
    if isinstance(scheme.model, SmoothLayDownModel):
        lag = curvature_lag(scheme.model, grid, found.first.ds)
        lag[DENSITY] = lag.pop("density_l1")
        parts["curvature"] = lag
    return parts


def check_boundary(
    result: PeriodicState, boundary_tolerance: float, tolerance: float, order: float
) -> None:
    """Raise if there is mass at the edge at some phase."""
    grid: Any = result.grid
    share = max(diagnostics.boundary_mass(p, grid) for p in result.densities)
    if isinstance(grid, SmoothPhaseSpaceGrid):
        ends = max(
            SmoothFunctionals(p, grid).kappa_boundary_mass() for p in result.densities
        )
        if not ends <= boundary_tolerance:
            raise CurvatureRangeError(ends, grid.kappa_half_width, boundary_tolerance)
    if share <= boundary_tolerance:
        return
    if result.errors["grid"] > max(result.errors["box"], WORTHLESS):
        raise ToleranceError(result.error, tolerance, advice(result, tolerance, order))
    raise DomainTooSmallError(share, grid.half_width, tolerance=boundary_tolerance)


def advice(result: PeriodicState, tolerance: float, order: float) -> str:
    """What would do; the box as on the mean belt, along which e^{−B} falls as fast."""
    return remedy(replace(result, model=on_mean_belt(result.model)), tolerance, order)
