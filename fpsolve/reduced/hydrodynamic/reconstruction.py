"""From 𝒫(ξ) back to p(ξ, α): the first terms of the Chapman-Enskog expansion."""

from __future__ import annotations

import math

import numpy as np

from fpsolve._support.arrays import Array, check_finite_numbers
from fpsolve._support.checks import check_non_negative, check_positive, shown
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.plane import PlaneGrid
from fpsolve.model.persistence import Persistence
from fpsolve.model.potentials.at_points import value_at
from fpsolve.model.potentials.potential import Potential

__all__ = ["balanced_gradient", "reconstruct"]


# exp of more than this is clipped: it multiplies a density that has long underflowed.
_LARGEST_EXPONENT = 300.0


def reconstruct(
    density: Array,
    grid: PhaseSpaceGrid,
    potential: Potential,
    noise: float,
    *,
    order: int = 1,
    relaxation_length: float = 0.0,
) -> Array:
    """p ≈ 𝒫/2π + ε p₁, p₁ = −(1/π) τ(α)·(F∇ + ∇B)𝒫, on the phase-space grid.

    F = 1 for the basic model; for a smooth fibre see `Persistence`, and p is the
    density of (ξ, α).

    Inserting p = 𝒫/2π + ε p₁ in (7) leaves at order one ½ ∂_αα p₁ =
    (1/2π) τ·(∇ + ∇B)𝒫, and τ'' = −τ: the factor is −1/π, where the paper, which drops
    1/2π, prints −2. p₁ carries the mean direction: ∫ τ p dα = −ε(∇ + ∇B)𝒫 is the
    diffusive flux, and E cos α = −v in the stationary state.

    Exact: ∫ p dα = 𝒫 and the mass. The gradient is taken as F e^{−B/F}∇(e^{B/F}𝒫), so
    p₁ vanishes to rounding where 𝒫 is a multiple of e^{−B/F}; of order 2 in the cell
    width otherwise. Can fail: p < 0 where ε|(F∇ + ∇B)𝒫| > 𝒫/2; nothing is clipped.

    Parameters
    ----------
    density : ndarray, shape (n1, n2)
        𝒫 on the cells of the grid in ξ.
    grid : PhaseSpaceGrid
    potential : Potential
        B, without the belt.
    noise : float
        A; ε = 1/A².
    order : {0, 1}
        0 leaves p₁ out.
    relaxation_length : float
        R of a smooth fibre.

    Returns
    -------
    ndarray, shape ``grid.shape``

    References
    ----------
    [KMW09]_, equation (18) and the one below (20); [BGKMW08]_.
    """
    if isinstance(order, bool) or order not in (0, 1):
        raise ValueError(f"`order` must be 0 or 1, got {shown(order)}.")
    plane = PlaneGrid.of(grid)
    density = check_finite_numbers("P", plane.check(density, "P"))
    epsilon = 1.0 / check_positive("noise", noise) ** 2
    p = np.repeat(density[:, :, None] / (2 * math.pi), grid.shape[2], axis=2)
    if order == 0:
        return p
    length = check_non_negative("relaxation_length", relaxation_length)
    factor = Persistence(noise, length).factor
    slope1, slope2 = balanced_gradient(density, plane, potential, factor)
    cosine, sine = np.cos(grid.alpha), np.sin(grid.alpha)
    along = slope1[:, :, None] * cosine + slope2[:, :, None] * sine
    return np.asarray(p - epsilon / math.pi * along)


def balanced_gradient(
    density: Array, plane: PlaneGrid, potential: Potential, factor: float = 1.0
) -> tuple[Array, Array]:
    """(F∇ + ∇B)𝒫 = F e^{−B/F} ∇(e^{B/F}𝒫) by centred differences, two (n1, n2) arrays.

    At the walls differences are one-sided, of order 2 like the others.
    """
    b = value_at(potential, *plane.mesh()) / factor
    return (
        factor * _derivative(density, b, plane.spacing[0], 0),
        factor * _derivative(density, b, plane.spacing[1], 1),
    )


def _derivative(density: Array, b: Array, h: float, axis: int) -> Array:
    """e^{−B} ∂(e^{B}𝒫) along an axis."""
    p, b = np.moveaxis(density, axis, 0), np.moveaxis(b, axis, 0)
    out = np.empty_like(p)
    out[1:-1] = _lifted(p, b, 2, None, 1) - _lifted(p, b, 0, -2, 1)
    if len(p) > 2:
        # −3u₀ + 4u₁ − u₂, and its mirror image.
        for end, near, far, sign in ((0, 1, 2, 1.0), (-1, -2, -3, -1.0)):
            first, second = _carried(p, b, near, end), _carried(p, b, far, end)
            out[end] = sign * (-3.0 * p[end] + 4.0 * first - second)
    else:
        out[0] = 2.0 * (_carried(p, b, 1, 0) - p[0])
        out[1] = 2.0 * (p[1] - _carried(p, b, 0, 1))
    return np.moveaxis(out / (2.0 * h), 0, axis)


def _carried(p: Array, b: Array, origin: int, to: int) -> Array:
    """𝒫 e^{B} at one row, times e^{−B} at another."""
    rise = np.minimum(b[origin] - b[to], _LARGEST_EXPONENT)
    return np.asarray(p[origin] * np.exp(rise))


def _lifted(p: Array, b: Array, start: int, stop: int | None, skipped: int) -> Array:
    """𝒫 e^{B} of the neighbours on one side, times e^{−B} of the inner cells."""
    inner = b[skipped:-skipped]
    rise = np.minimum(b[start:stop] - inner, _LARGEST_EXPONENT)
    return np.asarray(p[start:stop] * np.exp(rise))
