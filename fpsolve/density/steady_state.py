"""Stationary densities: explicit on a fixed belt, by Krylov iteration otherwise."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from fpsolve._support.arrays import Array
from fpsolve._support.blas import one_blas_thread
from fpsolve._support.checks import check_flag, check_tolerance
from fpsolve._support.memory import check_memory, required_memory
from fpsolve.density.schemes import drift_kick
from fpsolve.density.schemes.dictionaries import described_scheme
from fpsolve.density.schemes.drift_kick import DriftKick
from fpsolve.density.schemes.scheme import Scheme, checked_scheme
from fpsolve.density.smooth.lag import curvature_lag
from fpsolve.density.smooth.smooth_drift_kick import SmoothDriftKick
from fpsolve.density.stationary.at_rest import at_rest
from fpsolve.density.stationary.estimates import (
    DENSITY,
    box_error,
    field_error,
    scaled,
    signed_error,
    total,
)
from fpsolve.density.stationary.iteration import Stationary, settled, stationary
from fpsolve.density.stationary.other_schemes import judged, own_density
from fpsolve.density.stationary.refinement import Refined, refined
from fpsolve.density.stationary.remedies import WORTHLESS, check_error, remedy
from fpsolve.density.stationary.requirements import check_stationary, checked_step
from fpsolve.density.stationary.result import SteadyState
from fpsolve.density.suggestions import suggest_step
from fpsolve.errors import CurvatureRangeError, DomainTooSmallError, ToleranceError
from fpsolve.evolution.call import recorded
from fpsolve.grids import diagnostics
from fpsolve.grids.phase_space import check_grid
from fpsolve.grids.smooth import AnyGrid, SmoothPhaseSpaceGrid, check_smooth_grid
from fpsolve.grids.smooth_sums import SmoothFunctionals
from fpsolve.model.fibre import FibreModel
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.smooth import SmoothLayDownModel

__all__ = ["SteadyState", "steady_state"]


# High order costs next to nothing beside the angle step.
INTERPOLATION_ORDER = 12
# Error of one run at the first step, before three step lengths are combined; and
# A² ds of it, within which they have an asymptotic law.
FIRST_ERROR, LARGEST_TURN = 0.05, 1.5
# Share of the tolerance for the step; the grid takes the most.
STEP_SHARE = 0.2
# Densities that the Krylov iteration keeps, and the strides.
DIRECTIONS = 60.0
# The combination that a single step length is compared with has an error, too.
COMPARED = 1.25


@recorded(model=described_scheme)
@one_blas_thread()
def steady_state(
    model: FibreModel | Scheme,
    grid: AnyGrid | None = None,
    *,
    ds: float | None = None,
    tolerance: float = 1e-9,
    extrapolate: bool = False,
    boundary_tolerance: float = 1e-3,
    error_tolerance: float = 1e-4,
) -> SteadyState:
    """Density with L* p = 0 on the grid, with its error in L1.

    On a fixed belt it is p_S = c e^{−B} (10), whatever the noise. On a belt of constant
    speed v, and of a smooth fibre on any belt, it is the fixed point of an evolution
    over about a unit of arclength, extrapolated from three step lengths, found by a
    recycled Krylov iteration on half of the cells, three quarters, and all. Conserved:
    mass. Steps are shortened until their error is a fifth of `error_tolerance`; the
    cells and the box are as given, so that their errors can only be estimated: compare
    `errors`. Where a scheme corrects what is read, as `smooth_drift_kick` does, the
    density is what `solve` records of one that no longer changes.

    Parameters
    ----------
    model : LayDownModel, SmoothLayDownModel or Scheme
        A model on a moving belt is solved with `drift_kick(model, grid,
        interpolation_order=12)`, a smooth one with `smooth_drift_kick`. A scheme must
        be linear (not `positive`, not limited). Of another than these, and of p/p_S,
        the density is that of one step as it is, and its error is told by its distance
        from the density of the model.
    grid : PhaseSpaceGrid or SmoothPhaseSpaceGrid
        May be left out for a scheme, which has one.
    ds : float, optional
        A step to use as it is, however large its error; ds alone unless `extrapolate`.
    tolerance : float
        Residual to reach.
    extrapolate : bool
        With `ds`, or another scheme than `drift_kick`: combine ds with ds/2, and with
        ds/3 if that is `drift_kick`.
    boundary_tolerance : float
        Largest share of mass in the outermost cells.
    error_tolerance : float
        Error in L1 above which the result comes with a warning.

    Raises
    ------
    ValueError
        If there is no unique stationary density: a rotating or oscillating nozzle, a
        potential that does not confine, no noise, a linear potential too weak for the
        belt; for a scheme that is not linear; or for fewer than 6 cells in a
        direction on a moving belt.
    SteadyStateError
        If the residual stays above `tolerance`.
    DomainTooSmallError, CurvatureRangeError
        If the box cuts the density off, or the range of the curvature.
    MemoryLimitError
        If the directions that are remembered need more memory than there is.
    ToleranceError
        If the error is estimated above 0.1 (and above `error_tolerance`): the grid
        does not resolve the density.

    Warns
    -----
    UserWarning
        If the error is estimated above `error_tolerance`, with its parts and with the
        grid that would do.

    References
    ----------
    [KMW09]_, section 3.1.1, equation (10); section 3.1.2 for the moving belt.
    """
    scheme = scheme_for(model, grid)
    check_stationary(scheme.model)
    request = Request(
        None if ds is None else checked_step(ds),
        check_tolerance("tolerance", tolerance),
        check_flag("extrapolate", extrapolate),
        check_tolerance("error_tolerance", error_tolerance),
    )
    boundary_tolerance = check_tolerance("boundary_tolerance", boundary_tolerance)
    smooth = isinstance(scheme, SmoothDriftKick)
    if scheme.model.curve.fixed and not smooth:
        result, order = at_rest(scheme, request.ds or first_step(scheme)), 2.0
    elif smooth or (isinstance(scheme, DriftKick) and not scheme.balanced):
        result, order = by_palindrome(scheme, request)
    else:
        result, order = by_scheme(scheme, request)
    check_boundary(result, boundary_tolerance, request.error_tolerance, order)
    tolerance = request.error_tolerance
    check_error(
        "stationary", result, tolerance, lambda: remedy(result, tolerance, order)
    )
    return result


@dataclass(frozen=True)
class Request:
    """The arguments of `steady_state`, checked."""

    ds: float | None
    tolerance: float
    extrapolate: bool
    error_tolerance: float


def by_palindrome(scheme: DriftKick, request: Request) -> tuple[SteadyState, float]:
    """On coarser grids first; with the order at which their densities converge."""
    goal = STEP_SHARE * min(request.error_tolerance, WORTHLESS)

    def solver(here: DriftKick, start: Array, ds: float) -> Stationary:
        # The residual matters on the finest grid only.
        residual = request.tolerance if here.grid == scheme.grid else math.inf
        if request.ds is None:
            return settled(here, ds, start, goal, residual)
        return stationary(here, ds, start, goal, residual, request.extrapolate)

    found = refined(scheme, request.ds or first_step(scheme), solver)
    combined = request.extrapolate or request.ds is None
    return with_errors(scheme, found, combined), found.order


def by_scheme(scheme: Scheme, request: Request) -> tuple[SteadyState, float]:
    """The scheme's own density, compared with that of the palindrome."""
    palindrome = scheme_for(scheme.model, scheme.grid)
    assert isinstance(palindrome, DriftKick)
    reference, order = by_palindrome(palindrome, replace(request, ds=None))
    ds = request.ds or float(suggest_step(scheme.model, scheme.grid))
    own = own_density(scheme, ds, request.tolerance, request.extrapolate)
    return judged(scheme, own, reference), order


def first_step(scheme: Scheme) -> float:
    """A step that is long, but within the law of its error."""
    ds = float(suggest_step(scheme.model, scheme.grid, FIRST_ERROR))
    turn = LARGEST_TURN / max(scheme.model.noise, 1e-3) ** 2
    return min(ds, 1.0 / math.ceil(1.0 / turn))


def scheme_for(model: Any, grid: Any) -> Any:
    """The scheme to iterate, checked."""
    if isinstance(model, FibreModel) and grid is None:
        raise TypeError("`grid` is needed with a model; pass a PhaseSpaceGrid.")
    cells = grid if isinstance(model, FibreModel) else getattr(model, "grid", None)
    if isinstance(cells, SmoothPhaseSpaceGrid):
        check_memory(required_memory(cells.nbytes, DIRECTIONS, 0))
    if isinstance(model, SmoothLayDownModel):
        check_smooth_grid(grid)
        order = INTERPOLATION_ORDER
        return SmoothDriftKick(model, grid, interpolation_order=order)
    if isinstance(model, LayDownModel):
        check_grid(grid)
        # On a belt p/p_S grows without bound along it.
        return drift_kick(
            model, grid, balanced=model.curve.fixed and model.potential.normalisable,
            interpolation_order=INTERPOLATION_ORDER,
        )  # fmt: skip
    checked_scheme(model, "model")
    if grid is not None and grid != model.grid:
        raise ValueError(f"`grid` must be the scheme's own {model.grid}, got {grid}.")
    for option in ("positive", "limited"):
        if model.options.get(option):
            raise ValueError(
                f"`scheme` must be linear, got one with {option}=True; leave it out."
            )
    return model


def with_errors(scheme: Any, found: Refined, extrapolated: bool) -> SteadyState:
    """The density on the finest grid with all parts of its error."""
    p, grid = found.finest.density, scheme.grid
    step = field_error(found.finest.step, p, grid)
    parts: Mapping[str, Mapping[str, float]] = {
        "step": step if extrapolated else scaled(step, COMPARED),
        "grid": field_error(found.grid_error, p, grid),
        "box": box_error(p, grid),
        "iteration": field_error(found.finest.iteration, p, grid),
    }
    if isinstance(scheme, SmoothDriftKick):
        lag = curvature_lag(scheme.model, scheme.grid, found.finest.ds)
        lag[DENSITY] = lag.pop("density_l1")
        parts = {**parts, "curvature": lag}
    errors = total(parts)
    return SteadyState(
        density=p,
        residual=found.finest.residual,
        grid=grid,
        ds=found.finest.ds,
        n_applications=found.n_applications,
        error=errors.pop(DENSITY),
        errors={name: part[DENSITY] for name, part in parts.items()},
        moment_errors=errors,
        splitting=signed_error(found.finest.splitting, p, grid),
        extrapolated=extrapolated,
        model=scheme.model,
    )


def check_boundary(
    result: SteadyState, boundary_tolerance: float, tolerance: float, order: float
) -> None:
    """Raise if there is mass at the edge: the box cuts it off, or it is but noise."""
    share = diagnostics.boundary_mass(result.density, result.grid)
    grid: Any = result.grid
    if isinstance(grid, SmoothPhaseSpaceGrid):
        ends = SmoothFunctionals(result.density, grid).kappa_boundary_mass()
        if ends > boundary_tolerance:
            raise CurvatureRangeError(ends, grid.kappa_half_width, boundary_tolerance)
    if share <= boundary_tolerance:
        return
    if result.errors["grid"] > max(result.errors["box"], WORTHLESS):
        raise ToleranceError(result.error, tolerance, remedy(result, tolerance, order))
    raise DomainTooSmallError(
        share, result.grid.half_width, tolerance=boundary_tolerance
    )
