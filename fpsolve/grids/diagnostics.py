"""What is read off a density p[i, j, k]: mass, entropy, marginals, moments."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_non_negative, check_one_of
from fpsolve.grids.phase_space import PhaseSpaceGrid, check_grid
from fpsolve.grids.reference import as_field, reference_sum
from fpsolve.grids.row_sums import SMALLEST, RowFunctionals, inverse_of
from fpsolve.grids.smooth import AnyGrid, SmoothPhaseSpaceGrid
from fpsolve.grids.smooth_sums import SmoothFunctionals

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


CELLS_PER_SLAB = 32768
# Share of the largest value of a reference below which it says nothing of slopes.
LEAST_OF_LARGEST = 1e-6
# Staggered weights of order eight, from the nearest pair outward.
DIFFERENCE = (1225 / 1024, -245 / 3072, 49 / 5120, -5 / 7168)
MIDPOINT = (1225 / 2048, -245 / 2048, 49 / 2048, -5 / 2048)


def mass(p: Array, grid: AnyGrid) -> float:
    """∫ p dξ dα by the midpoint rule, one for a probability density.

    Parameters
    ----------
    p : ndarray, shape (n1, n2, n_alpha)
    grid : PhaseSpaceGrid or SmoothPhaseSpaceGrid
    """
    return float(checked(p, grid).sum()) * grid.cell_volume


def boundary_mass(p: Array, grid: AnyGrid) -> float:
    """Share of ∫ |p| dξ dα in the outermost layer of cells of the ξ box.

    The box is periodic, so what arrives there re-enters on the other side: a run is
    meaningful as long as this number is negligible.

    Parameters
    ----------
    p : ndarray, shape (n1, n2, n_alpha)
    grid : PhaseSpaceGrid or SmoothPhaseSpaceGrid
    """
    p = checked(p, grid)
    return ring_share(np.abs(p).sum(axis=tuple(range(2, p.ndim))))


def ring_share(plane: Array) -> float:
    """Share of a sum over the plane that lies in its outermost cells."""
    sides = plane[0].sum() + plane[-1].sum()
    ends = plane[1:-1, 0].sum() + plane[1:-1, -1].sum()
    return float((sides + ends) / plane.sum())


def negative_mass(p: Array, grid: AnyGrid) -> float:
    """∫ max(−p, 0) dξ dα: how much of a density is unphysical undershoot.

    Parameters
    ----------
    p : ndarray, shape (n1, n2, n_alpha)
    grid : PhaseSpaceGrid or SmoothPhaseSpaceGrid
    """
    return float(np.maximum(-checked(p, grid), 0.0).sum()) * grid.cell_volume


def marginal(p: Array, grid: AnyGrid, which: str = "xi") -> Array:
    """∫ p over the other variables, a density of those that are named.

    Parameters
    ----------
    p : ndarray, shape (n1, n2, n_alpha)
    grid : PhaseSpaceGrid or SmoothPhaseSpaceGrid
    which : str
        "xi", "alpha", "xi1" or "xi2"; on a grid with a curvature "kappa" and
        "xi_alpha" as well.

    Returns
    -------
    ndarray, shape (n1, n2), (n_alpha,), (n1,) or (n2,); (n_kappa,), (n1, n2, n_alpha)
    """
    p, numbers = checked(p, grid), range(len(grid.shape))
    kept = {"xi": (0, 1), "alpha": (2,), "xi1": (0,), "xi2": (1,)}
    if len(grid.shape) > 3:
        kept |= {"kappa": (3,), "xi_alpha": (0, 1, 2)}
    check_one_of("which", which, kept)
    axes = tuple(at for at in numbers if at not in kept[which])
    result: Array = p.sum(axis=axes) * math.prod(grid.spacing[at] for at in axes)
    return result


def moments(p: Array, grid: AnyGrid) -> dict[str, float]:
    """E ξ, the covariance of ξ, E cos α and E sin α, of the normalised density.

    Parameters
    ----------
    p : ndarray, shape (n1, n2, n_alpha)
    grid : PhaseSpaceGrid or SmoothPhaseSpaceGrid

    Returns
    -------
    dict of str to float
        mean_xi1, mean_xi2, variance_xi1, variance_xi2, covariance, mean_cos_alpha and
        mean_sin_alpha; on a grid with a curvature mean_kappa and mean_kappa2 as well.
    """
    p = checked(p, grid)
    if isinstance(grid, SmoothPhaseSpaceGrid):
        return SmoothFunctionals(p, grid).moments()
    return RowFunctionals(p, grid).moments()


def relative_entropy(p: Array, grid: AnyGrid, reference: Array) -> float:
    """H(p|r) = ∫ p ln(p/r) dξ dα (11), natural logarithm.

    Computed as ∫ p ln(p/r′) + M ln(M/S), where r′ = r M/S has the mass M of p on this
    grid and S is that of r: the logarithms are then as small as p is near r′, and an
    entropy of 1e-16 still has correct digits. Cells with p ≤ 0 contribute nothing,
    the limit of small p; look at the minimum beside it. r′ counts as 1e-300 where it is
    below: mass behind a wall of B > 690 makes H too small.

    Parameters
    ----------
    p : ndarray, shape (n1, n2, n_alpha)
    grid : PhaseSpaceGrid or SmoothPhaseSpaceGrid
    reference : ndarray, shape (n1, n2) or (n1, n2, n_alpha)
        Usually p_S = `model.equilibrium(*grid.plane())`, normalised on R² × [0, 2π).

    References
    ----------
    [KMW09]_, remark 3.2, equation (11).
    """
    p, reference = checked(p, grid), as_field(reference, grid)
    masses = np.sum(p), reference_sum(reference, grid)
    ratio = float(masses[0] / masses[1]) if masses[1] > 0 else math.nan
    if not ratio > 0:
        # No entropy without mass; the run's own checks say what went wrong.
        return math.nan
    if isinstance(grid, PhaseSpaceGrid) and reference.shape[2] == 1:
        inverse = inverse_of(reference[:, :, 0], ratio)
        return RowFunctionals(p, grid, inverse).relative_entropy(ratio)
    p, reference = rows_of(p), rows_of(reference)
    total = sum(entropy_of_slab(p[k], reference[k] * ratio) for k in slabs(grid))
    return (total + float(masses[0]) * math.log(ratio)) * grid.cell_volume


def rows_of(p: Array) -> Array:
    """p with all coordinates but ξ as one axis."""
    return p.reshape(*p.shape[:2], -1)


def entropy_of_slab(p: Array, reference: Array) -> float:
    """Σ p ln(p/r) − p + r over some planes; r depends on α."""
    logarithm: Array = p * inverse_of(reference, 1.0)
    np.maximum(logarithm, SMALLEST, out=logarithm)
    np.log(logarithm, out=logarithm)
    positive = np.einsum("ijk,ijk->", np.maximum(p, 0.0), logarithm)
    return float(positive - p.sum() + reference.sum())


def entropy_floor(grid: AnyGrid, reference: Array, total_mass: float = 1.0) -> float:
    """M ln(M/S): the entropy of the reference's own restriction to the grid.

    S is the mass of the reference on this grid; it differs from 1 by what the box
    cuts off and by the quadrature error. H tends to this value, not to zero.

    Parameters
    ----------
    grid : PhaseSpaceGrid or SmoothPhaseSpaceGrid
    reference : ndarray, shape (n1, n2) or (n1, n2, n_alpha)
    total_mass : float
        M, the mass of the density.
    """
    reference = as_field(reference, grid)
    total = reference_sum(reference, grid) * grid.cell_volume
    return total_mass * math.log(total_mass / total)


def entropy_dissipation(
    p: Array, grid: AnyGrid, noise: float, reference: Array | None = None
) -> float:
    """(A²/2) ∫ p (∂_α ln(p/r))² dξ dα = −dH/ds, of order 8 in Δα.

    Written as 2A² ∫ r (∂_α √(p/r))², which needs no logarithm and no division by p.
    A reference that does not depend on α (the default) drops out. On a grid with a
    curvature it is κ in the place of α, with the noise K.

    Parameters
    ----------
    p : ndarray, shape (n1, n2, n_alpha)
    grid : PhaseSpaceGrid or SmoothPhaseSpaceGrid
    noise : float
        A.
    reference : ndarray, shape (n1, n2) or (n1, n2, n_alpha), optional
        r.

    References
    ----------
    [KMW09]_, remark 3.2.
    """
    p, noise = checked(p, grid), check_non_negative("noise", noise)
    if isinstance(grid, PhaseSpaceGrid) and (
        reference is None or as_field(reference, grid).shape[2] == 1
    ):
        return RowFunctionals(p, grid).entropy_dissipation(noise)
    if reference is None:
        raise ValueError(
            "`reference` must be given on a grid with a curvature, got None; no "
            "stationary density is free of κ."
        )
    root = np.sqrt(np.maximum(p, 0.0) / np.maximum(reference, SMALLEST))
    slope, weight = staggered(root, DIFFERENCE, -1.0), staggered(reference, MIDPOINT, 1)
    if isinstance(grid, SmoothPhaseSpaceGrid):
        # A reference that was computed is rounding, or was cut at zero, in its tails.
        weight[beside(reference <= LEAST_OF_LARGEST * reference.max())] = 0.0
    total = float((weight * slope**2).sum()) / grid.spacing[-1] ** 2
    return 2.0 * noise**2 * total * grid.cell_volume


def staggered(q: Array, weights: tuple[float, ...], sign: float) -> Array:
    """Σ_j w_j (q[k+1+j] + sign · q[k−j]) along the last axis, periodic."""
    total = np.zeros_like(q)
    for j, weight in enumerate(weights):
        total += weight * (np.roll(q, -1 - j, axis=-1) + sign * np.roll(q, j, axis=-1))
    return total


def beside(marked: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Where a difference in the last direction uses a cell that is marked."""
    reached = np.zeros_like(marked)
    for j in range(len(DIFFERENCE)):
        reached |= np.roll(marked, -1 - j, axis=-1) | np.roll(marked, j, axis=-1)
    return reached


def l1_distance(p: Array, q: Array, grid: AnyGrid) -> float:
    """∫ |p − q| dξ dα by the midpoint rule.

    Parameters
    ----------
    p, q : ndarray, shape (n1, n2, n_alpha)
    grid : PhaseSpaceGrid or SmoothPhaseSpaceGrid
    """
    return float(np.abs(checked(p, grid) - q).sum()) * grid.cell_volume


def checked(p: Array, grid: AnyGrid) -> Array:
    """The density, of the shape of the grid; NaN in it shows in what is read off."""
    if not isinstance(grid, SmoothPhaseSpaceGrid):
        check_grid(grid)
    return grid.check(p)


def slabs(grid: AnyGrid) -> Iterator[slice]:
    """Blocks of planes small enough for the cache."""
    n1, *others = grid.shape
    n_planes = max(1, CELLS_PER_SLAB // math.prod(others))
    for start in range(0, n1, n_planes):
        yield slice(start, min(start + n_planes, n1))
