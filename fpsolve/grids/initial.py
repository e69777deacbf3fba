"""Initial densities, normalised on the grid."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import i0e

from fpsolve._support.arrays import check_numbers
from fpsolve._support.checks import (
    check_call,
    check_finite,
    check_kind,
    check_non_negative,
    check_pair,
    check_positive,
    shown,
)
from fpsolve.grids.phase_space import PhaseSpaceGrid, check_grid
from fpsolve.grids.smooth import AnyGrid, SmoothPhaseSpaceGrid, check_smooth_grid
from fpsolve.model.potentials.at_points import value_at
from fpsolve.model.potentials.potential import Potential

__all__ = ["equilibrium", "from_function", "gaussian", "with_curvature"]

# A sampled Gaussian misses its mass by more than this when it is cut by the box or
# narrower than about half a cell; the initial density is then not what was asked for.
_MASS_ERROR = 1e-2


def gaussian(
    grid: PhaseSpaceGrid,
    mean: tuple[float, float] = (0.0, 0.0),
    variance: ArrayLike = 1.0,
    angle: float | None = None,
    concentration: float = 0.0,
) -> NDArray[np.float64]:
    """p0 ∝ exp(-(ξ - m)ᵀ C⁻¹ (ξ - m)/2) exp(κ cos(α - α0)): Gaussian times von Mises.

    The mass on the grid is 1 to rounding.

    Parameters
    ----------
    grid : PhaseSpaceGrid
        The grid to sample on.
    mean : (float, float)
        Mean m of ξ, inside the box.
    variance : float, (float, float) or array_like of shape (2, 2)
        One variance for both components, one for each, or the covariance matrix C.
    angle : float, optional
        Mean direction α0 in radians; needed when `concentration` is positive.
    concentration : float
        Concentration κ >= 0 of the angle; 0 makes it uniform.

    Returns
    -------
    ndarray, shape ``grid.shape``

    Raises
    ------
    ValueError
        If the mean lies outside the box, the variance is not positive definite, the
        concentration is negative, or it is positive without an angle; also if the
        density is so narrow that it vanishes at every cell centre.

    Warns
    -----
    UserWarning
        If the sampled density misses its mass by more than 1 % before normalisation:
        it is cut by the box or too narrow for the cells.
    """
    check_grid(grid)
    mean1, mean2 = _checked_mean(grid, mean)
    covariance = checked_covariance(variance)
    precision = np.linalg.inv(covariance)
    xi1, xi2, alpha = grid.mesh()
    away1, away2 = xi1 - mean1, xi2 - mean2
    exponent = 0.5 * (
        precision[0, 0] * away1**2
        + 2 * precision[0, 1] * away1 * away2
        + precision[1, 1] * away2**2
    )
    plane = np.exp(-exponent) / (2 * math.pi * math.sqrt(np.linalg.det(covariance)))
    p = plane * _von_mises(alpha, angle, concentration)
    mass = float(p.sum()) * grid.cell_volume
    if not mass > 0:
        raise ValueError(
            "`variance` and `concentration` must leave mass on the cells, got "
            f"{shown(np.asarray(variance).tolist())} and {concentration:g}, which "
            f"vanish at every centre of cells of {_cells_text(grid)}; refine `shape`, "
            "or begin with a wider density."
        )
    _warn_when_badly_sampled(grid, mass)
    return _normalised(grid, p)


def equilibrium(grid: PhaseSpaceGrid, potential: Potential) -> NDArray[np.float64]:
    """p0 ∝ exp(-B(ξ)), uniform in α, normalised on the box.

    Parameters
    ----------
    grid : PhaseSpaceGrid
        The grid to sample on.
    potential : Potential
        Buckling potential B; it need not be normalisable on the plane.

    Returns
    -------
    ndarray, shape ``grid.shape``

    References
    ----------
    [KMW09]_, equation (10).
    """
    check_grid(grid)
    check_kind("potential", potential, Potential, "for instance QuadraticPotential()")
    value = value_at(potential, *grid.plane())
    # Only differences of B matter here, and the shift keeps exp from underflowing.
    weight = np.exp(value.min() - value)
    return _normalised(grid, np.broadcast_to(weight[:, :, None], grid.shape))


def from_function(
    grid: PhaseSpaceGrid, f: Callable[..., ArrayLike]
) -> NDArray[np.float64]:
    """p0 ∝ f(ξ1, ξ2, α), normalised on the grid.

    Parameters
    ----------
    grid : PhaseSpaceGrid
        The grid to sample on.
    f : callable
        ``f(xi1, xi2, alpha)`` on arrays that broadcast, non-negative and finite.

    Returns
    -------
    ndarray, shape ``grid.shape``

    Raises
    ------
    ValueError
        If `f` is negative or not finite somewhere, or zero everywhere.
    """
    check_grid(grid)
    check_call("f", f, "f(xi1, xi2, alpha)")
    p = grid.evaluate(f)
    if not np.all(np.isfinite(p)):
        raise ValueError("`f` must be finite on the grid, got NaN or infinity.")
    if not p.min() >= 0:
        raise ValueError(
            f"`f` must be non-negative on the grid, got {p.min():g}; a density is."
        )
    if not p.max() > 0:
        raise ValueError("`f` must be positive somewhere on the grid, got zero mass.")
    return _normalised(grid, p)


def with_curvature(
    p: ArrayLike, grid: SmoothPhaseSpaceGrid, variance: float
) -> NDArray[np.float64]:
    """p0(ξ, α, κ) ∝ p(ξ, α) exp(-κ²/2C): a start of a smooth fibre from a basic one.

    With C = K²R/2 = A²/(2R), `SmoothLayDownModel.curvature_variance`, it is the law of
    the curvature without a force. The mass on the grid is 1 to rounding.

    Parameters
    ----------
    p : array_like, shape (n1, n2, n_alpha)
        Density of (ξ, α), on ``grid.phase_space``.
    grid : SmoothPhaseSpaceGrid
    variance : float
        C.

    Returns
    -------
    ndarray, shape ``grid.shape``

    Raises
    ------
    ValueError
        If the variance is not positive, or the curvatures of the grid leave nothing.
    GridMismatchError
        If `p` is not on the cells of the grid.

    Warns
    -----
    UserWarning
        If 1 % of the Gaussian is cut by the grid or lost between its cells.
    """
    check_smooth_grid(grid)
    p = grid.phase_space.check(p)
    variance = check_positive("variance", variance)
    scale = math.sqrt(2 * math.pi * variance) / grid.spacing[3]
    share = np.exp(-0.5 * np.square(grid.kappa) / variance) / scale
    _warn_when_badly_sampled(grid, float(share.sum()))
    if not share.sum() > 0:
        raise ValueError(
            f"`variance` must leave mass on the curvatures of the grid, got "
            f"{variance:g} with cells of {grid.spacing[3]:g}; take more of them."
        )
    return _normalised(grid, p[..., None] * share)


def _normalised(grid: AnyGrid, p: NDArray[np.float64]) -> NDArray[np.float64]:
    scale: NDArray[np.float64] = p / (float(p.sum()) * grid.cell_volume)
    return np.ascontiguousarray(scale)


def _von_mises(
    alpha: NDArray[np.float64], angle: float | None, concentration: Any
) -> NDArray[np.float64]:
    """exp(κ cos(α - α0))/(2π I0(κ)), without overflow for large κ."""
    concentration = check_non_negative("concentration", concentration)
    if angle is not None:
        angle = check_finite("angle", angle)
    if concentration == 0:
        return np.full_like(alpha, 1 / (2 * math.pi))
    if angle is None:
        raise ValueError(
            f"`angle` must be given when `concentration` is positive, got None with "
            f"concentration {concentration:g}."
        )
    away = alpha - angle
    scale = 2 * math.pi * float(i0e(concentration))
    return np.asarray(np.exp(concentration * (np.cos(away) - 1)) / scale)


def _checked_mean(grid: PhaseSpaceGrid, mean: Any) -> tuple[float, float]:
    mean1, mean2 = check_pair("mean", mean)
    width1, width2 = grid.half_widths
    if not (abs(mean1) < width1 and abs(mean2) < width2):
        raise ValueError(
            f"`mean` must lie inside the box of half widths ({width1:g}, {width2:g}), "
            f"got ({mean1:g}, {mean2:g}); enlarge `half_width` or move the mean."
        )
    return mean1, mean2


def checked_covariance(variance: ArrayLike) -> NDArray[np.float64]:
    """Return the 2x2 covariance matrix; ValueError unless positive definite."""
    given = check_numbers("variance", variance)
    if given.shape not in ((), (2,), (2, 2)):
        raise ValueError(
            "`variance` must be one number, two, or a 2x2 matrix, got shape "
            f"{given.shape}."
        )
    matrix = given if given.ndim == 2 else np.diag(np.broadcast_to(given, (2,)))
    symmetric = np.allclose(matrix, matrix.T, rtol=1e-12, atol=0.0)
    # Products of numbers as large as floating-point allows are not finite.
    with np.errstate(over="ignore", invalid="ignore"):
        determinant = float(np.linalg.det(matrix))
    finite = bool(np.isfinite(matrix).all())
    if not (finite and symmetric and matrix[0, 0] > 0 and 0 < determinant < math.inf):
        raise ValueError(
            "`variance` must be positive, as a matrix symmetric and positive definite, "
            f"got {given.tolist()}."
        )
    return matrix


def _warn_when_badly_sampled(grid: AnyGrid, mass: float) -> None:
    if not abs(mass - 1) <= _MASS_ERROR:
        warnings.warn(
            f"the sampled Gaussian had mass {mass:.3g} before normalisation: it is cut "
            f"by the box of half widths {_widths(grid)} or too narrow for cells of "
            f"{_cells_text(grid)}; enlarge `half_width` or refine `shape`.",
            UserWarning,
            stacklevel=3,
        )


def _cells_text(grid: AnyGrid) -> str:
    return str(tuple(round(step, 4) for step in grid.spacing))


def _widths(grid: AnyGrid) -> tuple[float, ...]:
    if isinstance(grid, SmoothPhaseSpaceGrid):
        return (*grid.half_widths, grid.kappa_half_width)
    return grid.half_widths
