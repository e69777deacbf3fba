"""The stationary density of any scheme, judged by that of the palindrome."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.density.schemes.scheme import Scheme
from fpsolve.density.stationary.correction import DISTURBANCE
from fpsolve.density.stationary.estimates import DENSITY, field_error, scaled, total
from fpsolve.density.stationary.result import SteadyState
from fpsolve.density.stationary.strides import Stride
from fpsolve.errors import SteadyStateError
from fpsolve.evolution.richardson import extrapolated, gain_of
from fpsolve.grids import diagnostics, initial

__all__ = ["judged", "own_density"]

MOST_CORRECTIONS, RESTART = 12, 20
LEAST_ACCURATE, MOST_ACCURATE = 1e-2, 1e-6


@dataclass(frozen=True)
class OwnDensity:
    """What a scheme leaves unchanged over a stride.

    Attributes
    ----------
    density : ndarray, shape (n1, n2, n_alpha)
    residual : float
    ds : float
    extrapolated : bool
    n_applications : int
    """

    density: Array
    residual: float
    ds: float
    extrapolated: bool
    n_applications: int


def own_density(
    scheme: Scheme, ds: float, tolerance: float, extrapolate: bool
) -> OwnDensity:
    """The density that a scheme reproduces over a stride, or two combined (Richardson).

    Raises
    ------
    SteadyStateError
        If the residual stays above `tolerance`.
    """
    start = initial.equilibrium(scheme.grid, scheme.model.potential)
    coarse = reproduced(Stride(scheme, ds), start, tolerance)
    if not extrapolate:
        return coarse
    fine = reproduced(Stride(scheme, ds / 2), coarse.density, tolerance)
    density = extrapolated(fine.density, coarse.density, gain_of(scheme.order))
    n = coarse.n_applications + fine.n_applications
    return OwnDensity(density, fine.residual, ds, True, n)


def reproduced(evolution: Stride, p: Array, tolerance: float) -> OwnDensity:
    """The density that a stride leaves unchanged, by Newton's method from p."""
    for _ in range(MOST_CORRECTIONS):
        image = evolution(p)
        distance = diagnostics.l1_distance(image, p, evolution.scheme.grid)
        residual = distance / evolution.stride
        if residual <= tolerance:
            n = evolution.n_applications
            return OwnDensity(p, residual, evolution.ds, False, n)
        p = improved(evolution, p, image, tolerance / distance)
    raise SteadyStateError(residual, tolerance)


def improved(evolution: Stride, p: Array, image: Array, goal: float) -> Array:
    """A better fixed point: p + d with (I − E′) d = E(p) − p, then normalised.

    E may depend on p a little more than linearly, through corrections of the mass:
    the derivative is that at p, and the next correction removes the rest.
    """
    from scipy.sparse.linalg import LinearOperator, gmres

    def lost(direction: Array) -> Array:
        size = float(np.abs(direction).sum())
        if size == 0.0:
            return direction
        scale = DISTURBANCE * float(np.abs(p).sum()) / size
        moved = evolution(p + scale * direction.reshape(p.shape))
        derivative: Array = direction - (moved - image).ravel() / scale
        return derivative

    operator = LinearOperator((p.size, p.size), matvec=lost, dtype=np.float64)
    rtol = min(max(0.05 * goal, MOST_ACCURATE), LEAST_ACCURATE)
    update, _ = gmres(
        operator, (image - p).ravel(), rtol=rtol, restart=RESTART, maxiter=1
    )
    better = p + update.reshape(p.shape)
    normalised: Array = better / diagnostics.mass(better, evolution.scheme.grid)
    return normalised


def judged(scheme: Scheme, own: OwnDensity, reference: SteadyState) -> SteadyState:
    """A scheme's density with the errors of a better one and its distance to that."""
    difference = own.density - reference.density
    parts = {
        "reference": {DENSITY: reference.error, **reference.moment_errors},
        "scheme": field_error(difference, own.density, scheme.grid),
    }
    errors = total(parts)
    # Both splittings are of order two, and differ by no more than a factor.
    splitting = scaled(reference.splitting, (own.ds / reference.ds) ** 2)
    return SteadyState(
        density=own.density,
        residual=own.residual,
        grid=scheme.grid,
        ds=own.ds,
        n_applications=own.n_applications + reference.n_applications,
        error=errors.pop(DENSITY),
        errors={**reference.errors, "scheme": parts["scheme"][DENSITY]},
        moment_errors=errors,
        splitting=splitting,
        extrapolated=own.extrapolated,
        model=scheme.model,
    )
