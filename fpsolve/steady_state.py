"""Stationary densities: explicit on a fixed belt, by Krylov iteration otherwise."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import i0e, i1e

from fpsolve import diagnostics, initial
from fpsolve._blas import one_blas_thread
from fpsolve._checks import check_flag, check_real, check_tolerance
from fpsolve.errors import DomainTooSmallError, SteadyStateError
from fpsolve.grids import PhaseSpaceGrid
from fpsolve.models import LayDownModel
from fpsolve.potentials import LinearPotential
from fpsolve.schemes import drift_kick
from fpsolve.schemes.form import State
from fpsolve.solve import Scheme, checked_scheme
from fpsolve.suggestions import suggest_step

__all__ = ["SteadyState", "steady_state"]

Array = NDArray[np.float64]

# One application of the map covers about this arclength: long enough for the slow
# modes to move, short enough that the fast ones cost few steps.
STRIDE = 1.0
RESTART = 20
OUTER = 12
# A stride of more steps than this would never end.
SHORTEST = 1e-9


@dataclass(frozen=True, eq=False)
class SteadyState:
    """A density that (7) leaves unchanged, and how well it does.

    Attributes
    ----------
    density : ndarray, shape (n1, n2, n_alpha)
        Normalised to mass one on the grid.
    residual : float
        ∫ |p_{s+σ} − p_s| dξ dα / σ of the scheme over a stride σ of about one: the
        rate at which the discrete equation still changes the density.
    grid : PhaseSpaceGrid
    ds : float
        Step of the scheme, on which the stationary density of a splitting depends to
        its order.
    n_applications : int
        Evolutions over the stride that it took.
    error : float or None
        Estimated ∫ |p − p_exact| due to ds, with `extrapolate`.
    """

    density: Array
    residual: float
    grid: PhaseSpaceGrid
    ds: float
    n_applications: int
    error: float | None = None

    def marginal(self, which: str) -> Array:
        """∫ p over the other variables: "xi", "alpha", "xi1" or "xi2"."""
        return diagnostics.marginal(self.density, self.grid, which)

    def moments(self) -> dict[str, float]:
        """E ξ, covariance of ξ, E cos α (−v for every potential), E sin α (0)."""
        return diagnostics.moments(self.density, self.grid)


@one_blas_thread()
def steady_state(
    model: LayDownModel | Scheme,
    grid: PhaseSpaceGrid | None = None,
    *,
    ds: float | None = None,
    tolerance: float = 1e-9,
    extrapolate: bool = False,
    boundary_tolerance: float = 1e-3,
) -> SteadyState:
    """Density with L* p = 0 on the grid, and its residual.

    On a fixed belt it is p_S = c e^{−B} (10), whatever the noise. On a belt of
    constant speed v the fixed point of the scheme is computed by GMRES on the
    evolution over about a unit of arclength, until the residual is below
    `tolerance`. Conserved: mass. The result carries the scheme's error in ds (order
    2); `extrapolate` removes its leading part and estimates it.

    Parameters
    ----------
    model : LayDownModel or Scheme
        A model is solved with `drift_kick(model, grid, balanced=True)`. A scheme
        must be linear (not `positive`, not limited).
    grid : PhaseSpaceGrid
        May be left out for a scheme, which has one.
    ds : float, optional
        Step; proposed by `suggest_step` if left out.
    tolerance : float
        Residual to reach.
    extrapolate : bool
        Solve with ds and ds/2 and combine (Richardson).
    boundary_tolerance : float
        Largest share of mass in the outermost cells.

    Raises
    ------
    ValueError
        If no stationary density exists: a rotating or oscillating nozzle, a potential
        that does not confine, no noise on a moving belt, a linear potential too weak
        for the belt, or a scheme that is not linear.
    SteadyStateError
        If the residual stays above `tolerance`.
    DomainTooSmallError
        If the box cuts the density off.

    References
    ----------
    [KMW09]_, section 3.1.1, equation (10); section 3.1.2 for the moving belt.
    """
    scheme = scheme_for(model, grid)
    check_stationary(scheme.model)
    tolerance = check_tolerance("tolerance", tolerance)
    boundary_tolerance = check_tolerance("boundary_tolerance", boundary_tolerance)
    extrapolate = check_flag("extrapolate", extrapolate)
    ds = checked_step(suggest_step(scheme.model, scheme.grid) if ds is None else ds)
    result = fixed_point(scheme, ds, tolerance)
    if extrapolate and not scheme.model.curve.fixed:
        finer = fixed_point(scheme, ds / 2, tolerance, start=result.density)
        result = combined(result, finer, scheme.order)
    check_boundary(result, boundary_tolerance)
    return result


def checked_step(ds: float) -> float:
    """The step as a float, positive and not so short that no unit of s is reached."""
    ds = check_real("ds", ds)
    if not (math.isfinite(ds) and ds > 0):
        raise ValueError(f"`ds` must be positive, got {ds:g}.")
    if not ds >= SHORTEST:
        raise ValueError(
            f"`ds` must be at least {SHORTEST:g}, got {ds:g}; one evaluation goes over "
            "about a unit of arclength."
        )
    return ds


def scheme_for(model: LayDownModel | Scheme, grid: PhaseSpaceGrid | None) -> Scheme:
    """The scheme to iterate, checked."""
    if isinstance(model, LayDownModel):
        if grid is None:
            raise TypeError("`grid` is needed with a model; pass a PhaseSpaceGrid.")
        return drift_kick(model, grid, balanced=model.potential.normalisable)
    checked_scheme(model, "model")
    if grid is not None and grid != model.grid:
        raise ValueError(f"`grid` must be the scheme's own {model.grid}, got {grid}.")
    for option in ("positive", "limited"):
        if model.options.get(option):
            raise ValueError(
                f"`scheme` must be linear, got one with {option}=True; leave it out."
            )
    return model


def check_stationary(model: LayDownModel) -> None:
    """Raise ValueError if the model has no stationary density."""
    if not model.curve.autonomous:
        raise ValueError(
            f"`curve` must move at constant speed, got {model.curve!r}; under a "
            "rotating or oscillating nozzle the density never comes to rest."
        )
    if not model.potential.normalisable:
        raise ValueError(
            f"`potential` must confine, got {model.potential!r}: exp(-B) has no "
            "finite integral."
        )
    if model.curve.fixed:
        return
    if not model.noise > 0:
        raise ValueError(
            "`noise` must be positive on a moving belt, got 0; without noise the "
            "density does not converge."
        )
    check_linear_strength(model)


def check_linear_strength(model: LayDownModel) -> None:
    """Raise unless v < I₁(2K/A²)/I₀(2K/A²), which |ξ| buckling needs to hold on."""
    if not isinstance(model.potential, LinearPotential):
        return
    strength = 2.0 * model.potential.slope / model.noise**2
    largest = float(i1e(strength) / i0e(strength))
    if not abs(model.belt_speed) < largest:
        raise ValueError(
            f"`speed` must be below I1(2K/A²)/I0(2K/A²) = {largest:.4g} for the linear "
            f"potential with K = {model.potential.slope:g} and A = {model.noise:g}, "
            f"got {model.belt_speed:g}; the fibre is otherwise carried away."
        )


def fixed_point(
    scheme: Scheme, ds: float, tolerance: float, start: Array | None = None
) -> SteadyState:
    """The density that the scheme reproduces over a stride, to `tolerance`."""
    evolution = Evolution(scheme, ds)
    density = initial.equilibrium(scheme.grid, scheme.model.potential)
    density = density if start is None else start
    image = evolution(density)
    residual = evolution.residual(density, image)
    for _ in range(0 if scheme.model.curve.fixed else OUTER):
        if residual <= tolerance:
            break
        density = evolution.improved(density, image, tolerance)
        image = evolution(density)
        residual = evolution.residual(density, image)
    if not (scheme.model.curve.fixed or residual <= tolerance):
        raise SteadyStateError(residual, tolerance)
    return SteadyState(density, residual, scheme.grid, ds, evolution.n_applications)


class Evolution:
    """The density evolved over a stride, as a map for a Krylov solver."""

    def __init__(self, scheme: Scheme, ds: float) -> None:
        self.scheme, self.ds = scheme, ds
        self.n_steps = max(1, round(STRIDE / ds))
        self.n_applications = 0

    def __call__(self, p: Array) -> Array:
        """Evolve p over the stride."""
        self.n_applications += 1
        state: State = self.scheme.start(p)
        self.scheme.advance(state, 0.0, self.ds, self.n_steps)
        return self.scheme.density(state).copy()

    def residual(self, p: Array, image: Array) -> float:
        """∫ |p_{s+σ} − p_s| dξ dα / σ over the stride σ."""
        distance = diagnostics.l1_distance(image, p, self.scheme.grid)
        return distance / (self.n_steps * self.ds)

    def improved(self, p: Array, image: Array, tolerance: float) -> Array:
        """A better fixed point: p + d with (I − E′) d = E(p) − p, then normalised.

        E is homogeneous but, because of its mass correction, not quite linear; its
        derivative at p is taken by a difference, which is exact up to that
        correction, and the outer iteration removes the rest.
        """
        from scipy.sparse.linalg import LinearOperator, gmres

        defect = (image - p).ravel()

        def lost(direction: Array) -> Array:
            size = float(np.abs(direction).sum())
            if size == 0.0:
                return direction
            scale = 0.1 * float(np.abs(p).sum()) / size
            moved = self(p + scale * direction.reshape(p.shape))
            derivative: Array = direction - (moved - image).ravel() / scale
            return derivative

        operator = LinearOperator((p.size, p.size), matvec=lost, dtype=np.float64)
        size = float(np.abs(defect).sum()) * self.scheme.grid.cell_volume
        goal = min(max(0.05 * tolerance / size, 1e-6), 1e-2)
        update, _ = gmres(operator, defect, rtol=goal, restart=RESTART, maxiter=1)
        better = p + update.reshape(p.shape)
        normalised: Array = better / diagnostics.mass(better, self.scheme.grid)
        return normalised


def combined(coarse: SteadyState, fine: SteadyState, order: int) -> SteadyState:
    """Richardson combination of two stationary densities, with its estimate."""
    gain = 1.0 / (2**order - 1)
    change = fine.density - coarse.density
    return SteadyState(
        density=fine.density + gain * change,
        residual=fine.residual,
        grid=fine.grid,
        ds=coarse.ds,
        n_applications=coarse.n_applications + fine.n_applications,
        error=gain * diagnostics.l1_distance(fine.density, coarse.density, fine.grid),
    )


def check_boundary(result: SteadyState, tolerance: float) -> None:
    """Raise DomainTooSmallError if the box cuts the density off."""
    share = diagnostics.boundary_mass(result.density, result.grid)
    if not share <= tolerance:
        raise DomainTooSmallError(share, result.grid.half_width, tolerance=tolerance)
