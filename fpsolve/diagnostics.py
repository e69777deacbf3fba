"""What is read off a density p[i, j, k]: mass, entropy, marginals, moments."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from fpsolve._kernels.functionals import N_FUNCTIONALS, row_functionals
from fpsolve.grids import PhaseSpaceGrid

__all__ = [
    "boundary_mass",
    "entropy_dissipation",
    "entropy_floor",
    "l1_distance",
    "marginal",
    "mass",
    "moments",
    "negative_mass",
    "relative_entropy",
]

Array = NDArray[np.float64]

CELLS_PER_SLAB = 32768
# Reference values below this carry no mass; they only have to be divisible.
SMALLEST = 1e-300
MOMENTS = (
    "mean_xi1",
    "mean_xi2",
    "variance_xi1",
    "variance_xi2",
    "covariance",
    "mean_cos_alpha",
    "mean_sin_alpha",
)
# Staggered weights of order eight, from the nearest pair outward.
DIFFERENCE = (1225 / 1024, -245 / 3072, 49 / 5120, -5 / 7168)
MIDPOINT = (1225 / 2048, -245 / 2048, 49 / 2048, -5 / 2048)


def mass(p: Array, grid: PhaseSpaceGrid) -> float:
    """∫ p dξ dα by the midpoint rule, one for a probability density."""
    return float(np.sum(p)) * grid.cell_volume


def boundary_mass(p: Array, grid: PhaseSpaceGrid) -> float:
    """Share of ∫ |p| dξ dα in the outermost layer of cells of the ξ box.

    The box is periodic, so what arrives there re-enters on the other side: a run is
    meaningful as long as this number is negligible.
    """
    return ring_share(np.abs(np.asarray(p)).sum(axis=2))


def ring_share(plane: Array) -> float:
    """Share of a sum over the plane that lies in its outermost cells."""
    sides = plane[0].sum() + plane[-1].sum()
    ends = plane[1:-1, 0].sum() + plane[1:-1, -1].sum()
    return float((sides + ends) / plane.sum())


def negative_mass(p: Array, grid: PhaseSpaceGrid) -> float:
    """∫ max(−p, 0) dξ dα: how much of a density is unphysical undershoot."""
    return float(np.maximum(-np.asarray(p), 0.0).sum()) * grid.cell_volume


def marginal(p: Array, grid: PhaseSpaceGrid, which: str = "xi") -> Array:
    """∫ p over the other variables: "xi" (n1, n2), "alpha", "xi1" or "xi2" (1-D)."""
    d1, d2, d_alpha = grid.spacing
    integrals = {
        "xi": ((2,), d_alpha),
        "alpha": ((0, 1), d1 * d2),
        "xi1": ((1, 2), d2 * d_alpha),
        "xi2": ((0, 2), d1 * d_alpha),
    }
    if which not in integrals:
        known = ", ".join(repr(name) for name in integrals)
        raise ValueError(f"`which` must be one of {known}, got {which!r}.")
    axes, measure = integrals[which]
    result: Array = np.asarray(p).sum(axis=axes) * measure
    return result


def moments(p: Array, grid: PhaseSpaceGrid) -> dict[str, float]:
    """E ξ, the covariance of ξ, E cos α and E sin α, of the normalised density."""
    return moments_of_rows(functionals(p, grid), grid)


def functionals(p: Array, grid: PhaseSpaceGrid) -> Array:
    """Sums over α for every ξ; shape (n1, n2, 6), see the kernel."""
    out = np.empty((*grid.shape[:2], N_FUNCTIONALS))
    row_functionals(p, np.cos(grid.alpha), np.sin(grid.alpha), out)
    return out


def moments_of_rows(rows: Array, grid: PhaseSpaceGrid) -> dict[str, float]:
    """Moments from the row functionals."""
    xi1, xi2 = grid.plane()
    share = rows[:, :, 0] / rows[:, :, 0].sum()
    mean1, mean2 = float((share * xi1).sum()), float((share * xi2).sum())
    away1, away2 = xi1 - mean1, xi2 - mean2
    values = (
        mean1,
        mean2,
        float((share * away1**2).sum()),
        float((share * away2**2).sum()),
        float((share * away1 * away2).sum()),
        float(rows[:, :, 1].sum() / rows[:, :, 0].sum()),
        float(rows[:, :, 2].sum() / rows[:, :, 0].sum()),
    )
    return dict(zip(MOMENTS, values, strict=True))


def relative_entropy(p: Array, grid: PhaseSpaceGrid, reference: Array) -> float:
    """H(p|r) = ∫ p ln(p/r) dξ dα (11), natural logarithm.

    Computed as ∫ [p ln(p/r′) − p + r′] + M ln(M/S), where r′ = r M/S has the mass M
    of p on this grid and S is that of r: every cell of the integral is then
    non-negative, and an entropy of 1e-16 still has correct digits. Cells with p ≤ 0
    contribute r′ − p, the limit of small p; look at the minimum beside it.

    Parameters
    ----------
    p : ndarray, shape (n1, n2, n_alpha)
    grid : PhaseSpaceGrid
    reference : ndarray, shape (n1, n2) or (n1, n2, n_alpha)
        Usually p_S = `model.equilibrium(*grid.plane())`, normalised on R² × [0, 2π).
    """
    reference = as_field(reference)
    masses = np.sum(p), reference_sum(reference, grid)
    ratio = float(masses[0] / masses[1])
    if not ratio > 0:
        # No entropy without mass; the run's own checks say what went wrong.
        return math.nan
    total = 0.0
    for part in slabs(grid):
        total += entropy_of_slab(p[part], reference[part] * ratio)
    return (total + float(masses[0]) * math.log(ratio)) * grid.cell_volume


def entropy_of_slab(p: Array, reference: Array) -> float:
    """Σ p ln(p/r) − p + r over some planes."""
    inverse = 1.0 / np.maximum(reference, SMALLEST)
    logarithm: Array = p * inverse
    np.maximum(logarithm, SMALLEST, out=logarithm)
    np.log(logarithm, out=logarithm)
    positive = np.einsum("ijk,ijk->", np.maximum(p, 0.0), logarithm)
    repeats = p.shape[2] // reference.shape[2]
    return float(positive - p.sum() + reference.sum() * repeats)


def entropy_floor(
    grid: PhaseSpaceGrid, reference: Array, total_mass: float = 1.0
) -> float:
    """M ln(M/S): the entropy of the reference's own restriction to the grid.

    S is the mass of the reference on this grid; it differs from 1 by what the box
    cuts off and by the quadrature error. H tends to this value, not to zero.
    """
    reference = as_field(reference)
    total = reference_sum(reference, grid) * grid.cell_volume
    return total_mass * math.log(total_mass / total)


def entropy_dissipation(
    p: Array, grid: PhaseSpaceGrid, noise: float, reference: Array | None = None
) -> float:
    """(A²/2) ∫ p (∂_α ln(p/r))² dξ dα = −dH/ds, of order 8 in Δα.

    Written as 2A² ∫ r (∂_α √(p/r))², which needs no logarithm and no division by p.
    A reference that does not depend on α (the default) drops out.
    """
    if reference is None or as_field(reference).shape[2] == 1:
        return dissipation_of_rows(functionals(p, grid), grid, noise)
    root = np.sqrt(np.maximum(p, 0.0) / np.maximum(reference, SMALLEST))
    slope, weight = staggered(root, DIFFERENCE, -1.0), staggered(reference, MIDPOINT, 1)
    total = float((weight * slope**2).sum()) / grid.spacing[2] ** 2
    return 2.0 * noise**2 * total * grid.cell_volume


def dissipation_of_rows(rows: Array, grid: PhaseSpaceGrid, noise: float) -> float:
    """Dissipation from the row functionals."""
    total = float(rows[:, :, 3].sum()) / grid.spacing[2] ** 2
    return 2.0 * noise**2 * total * grid.cell_volume


def staggered(q: Array, weights: tuple[float, ...], sign: float) -> Array:
    """Σ_j w_j (q[k+1+j] + sign · q[k−j]) along the angle, periodic."""
    total = np.zeros_like(q)
    for j, weight in enumerate(weights):
        total += weight * (np.roll(q, -1 - j, axis=2) + sign * np.roll(q, j, axis=2))
    return total


def l1_distance(p: Array, q: Array, grid: PhaseSpaceGrid) -> float:
    """∫ |p − q| dξ dα by the midpoint rule."""
    return float(np.abs(np.asarray(p) - q).sum()) * grid.cell_volume


def as_field(reference: Array) -> Array:
    """A reference as (n1, n2, 1) or (n1, n2, n_alpha)."""
    reference = np.asarray(reference, dtype=np.float64)
    return reference[:, :, None] if reference.ndim == 2 else reference


def reference_sum(reference: Array, grid: PhaseSpaceGrid) -> float:
    """Sum of a reference over all cells of the grid."""
    repeats = grid.shape[2] // reference.shape[2]
    return float(reference.sum()) * float(repeats)


def slabs(grid: PhaseSpaceGrid) -> Iterator[slice]:
    """Blocks of planes small enough for the cache."""
    n1, n2, n_alpha = grid.shape
    planes = max(1, CELLS_PER_SLAB // (n2 * n_alpha))
    for start in range(0, n1, planes):
        yield slice(start, min(start + planes, n1))
