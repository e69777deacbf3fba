"""Right-hand sides by central differences of second order, in conservative form.

Each builder returns a function of arrays alone, which runs in NumPy as it stands and
which numba compiles as it stands. Nothing is shared with the schemes of this package:
these are the independent comparator.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.plane import PlaneGrid
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.at_points import gradient_at, value_at

__all__ = [
    "phase_space_rate",
    "phase_space_rate_bound",
    "plane_drift",
    "plane_rate",
    "plane_rate_bound",
]


# e^{−B} may fall by e^{−600} from the centre of a cell to its face, not by more.
MOST_STEEP = 600.0


def phase_space_rate(
    model: LayDownModel, grid: PhaseSpaceGrid
) -> Callable[[Array, float, float], Array]:
    """∂ₛp = −∇·[w (τ, −∇B·τ⊥) h] + ∇·(γ′ p) + (A²/2) ∂_αα p, w = e^{−B}, h = p/w.

    On a face, h is the mean of its two cells, and w (τ, −∇B·τ⊥) = (w τ, ∇w·τ⊥) is the
    equilibrium's own flux, with w at the faces of ξ, ∇w their difference across the
    cell and τ⊥ scaled by (Δα/2)/sin(Δα/2), which makes it free of divergence to the
    digit. Hence, exactly: the mass; on a fixed belt the equilibrium stays, transport is
    antisymmetric in ∫ p²/p_S, and with the diffusion this falls. (Plain central
    differences of the same fluxes have growing modes at little noise.) Of order two
    in every spacing.

    Returns
    -------
    callable
        rate(p, γ₁′, γ₂′), shapes (n1, n2, n_alpha) to the same.
    """
    n1, n2, n_alpha = grid.shape
    half1, half2, half_alpha = (0.5 / width for width in grid.spacing)
    diffusion = 2 * model.diffusivity / grid.spacing[2]
    cosine, sine = np.cos(grid.alpha), np.sin(grid.alpha)
    upper1, lower1, upper2, lower2 = _face_ratios(model, grid)
    slope1, slope2 = _slopes(model, grid)
    turn_cosine, turn_sine = _faces_of_angle(grid)

    def rate(p, velocity1, velocity2):  # type: ignore[no-untyped-def]
        flux1 = np.empty((n1 + 1, n2, n_alpha))
        up, down = (cosine * upper1 - velocity1) * p, (cosine * lower1 - velocity1) * p
        flux1[1:-1] = up[:-1] + down[1:]
        flux1[0] = up[-1] + down[0]
        flux1[-1] = flux1[0]
        flux2 = np.empty((n1, n2 + 1, n_alpha))
        up, down = (sine * upper2 - velocity2) * p, (sine * lower2 - velocity2) * p
        flux2[:, 1:-1] = up[:, :-1] + down[:, 1:]
        flux2[:, 0] = up[:, -1] + down[:, 0]
        flux2[:, -1] = flux2[:, 0]
        q = np.empty((n1, n2, n_alpha + 2))
        q[:, :, 1:-1] = p
        q[:, :, 0], q[:, :, -1] = p[:, :, -1], p[:, :, 0]
        before, after = q[:, :, :-1], q[:, :, 1:]
        torque = slope2 * turn_cosine - slope1 * turn_sine
        turning = torque * (before + after) - diffusion * (after - before)
        return (
            half1 * (flux1[:-1] - flux1[1:])
            + half2 * (flux2[:, :-1] - flux2[:, 1:])
            + half_alpha * (turning[:, :, :-1] - turning[:, :, 1:])
        )

    return rate


def phase_space_rate_bound(
    model: LayDownModel, grid: PhaseSpaceGrid, velocity: tuple[float, float]
) -> float:
    """A bound on the eigenvalues of the rate: the largest column sum of its matrix."""
    d1, d2, d_alpha = grid.spacing
    upper1, lower1, upper2, lower2 = _face_ratios(model, grid)
    torque = np.hypot(*_slopes(model, grid))
    drift = (upper1 + lower1) / (2 * d1) + (upper2 + lower2) / (2 * d2)
    largest = float((drift + torque / d_alpha).max())
    carried = 2 * (abs(velocity[0]) / d1 + abs(velocity[1]) / d2)
    return largest + carried + 4 * model.diffusivity / d_alpha**2


def plane_drift(model: LayDownModel, grid: PlaneGrid) -> tuple[Array, Array]:
    """ε∇B − v e₁, its first component on the faces across ξ₁, its second across ξ₂.

    Shapes (n1 − 1, n2) and (n1, n2 − 1): the walls of the box have no flux.
    """
    strength = model.noise**-2
    xi1, xi2 = grid.mesh()
    face1, face2 = 0.5 * (xi1[1:] + xi1[:-1]), 0.5 * (xi2[:, 1:] + xi2[:, :-1])
    slope1 = gradient_at(model.potential, face1, xi2, "face")[0]
    slope2 = gradient_at(model.potential, xi1, face2, "face")[1]
    return strength * slope1 - model.belt_speed, strength * slope2


def plane_rate(model: LayDownModel, grid: PlaneGrid) -> Callable[[Array, float], Array]:
    """∂ₛ𝒫 = ∇·(ε∇𝒫 + (ε∇B − v e₁)𝒫) by central fluxes through the faces of a box.

    The flux is ε (𝒫₊ − 𝒫₋)/Δ + (ε∂B − v)(𝒫₊ + 𝒫₋)/2 on a face and zero on the walls:
    the sum over the cells vanishes to rounding. Of order two.

    Returns
    -------
    callable
        rate(P, s), shapes (n1, n2) to the same.
    """
    d1, d2 = grid.spacing
    diffusion1, diffusion2 = (model.noise**-2 / width**2 for width in (d1, d2))
    drift1, drift2 = plane_drift(model, grid)
    half1, half2 = 0.5 * drift1 / d1, 0.5 * drift2 / d2

    def rate(density, s):  # type: ignore[no-untyped-def]
        below, above = density[:-1], density[1:]
        flux1 = diffusion1 * (above - below) + half1 * (above + below)
        left, right = density[:, :-1], density[:, 1:]
        flux2 = diffusion2 * (right - left) + half2 * (right + left)
        result = np.zeros(density.shape)
        result[:-1] += flux1
        result[1:] -= flux1
        result[:, :-1] += flux2
        result[:, 1:] -= flux2
        return result

    return rate


def plane_rate_bound(model: LayDownModel, grid: PlaneGrid) -> float:
    """A bound on the eigenvalues of the rate: the largest column sum of its matrix."""
    total = 0.0
    for width, drift in zip(grid.spacing, plane_drift(model, grid), strict=True):
        total += 4 * model.noise**-2 / width**2 + 2 * float(np.abs(drift).max()) / width
    return total


def _face_ratios(
    model: LayDownModel, grid: PhaseSpaceGrid
) -> tuple[Array, Array, Array, Array]:
    """w at the upper and the lower face across ξ₁, then ξ₂, over w in the cell.

    Shapes (n1, n2, 1). The two ends of the periodic box are one face: B there is the
    mean of both.
    """
    xi1, xi2 = grid.plane()
    d1, d2, _ = grid.spacing

    def value(x1: Array, x2: Array) -> Array:
        # A copy: the ends are overwritten below.
        return value_at(model.potential, x1, x2, "face").copy()

    centre = value_at(model.potential, xi1, xi2)
    upper1, lower1 = value(xi1 + d1 / 2, xi2), value(xi1 - d1 / 2, xi2)
    upper2, lower2 = value(xi1, xi2 + d2 / 2), value(xi1, xi2 - d2 / 2)
    upper1[-1] = lower1[0] = 0.5 * (upper1[-1] + lower1[0])
    upper2[:, -1] = lower2[:, 0] = 0.5 * (upper2[:, -1] + lower2[:, 0])
    steepest = max(
        float((centre - face).max()) for face in (upper1, lower1, upper2, lower2)
    )
    if not steepest < MOST_STEEP:
        raise ValueError(
            f"`grid` must resolve exp(-B), got B that changes by {steepest:.2g} in "
            "half a cell; take more cells, or a smaller `half_width`."
        )
    ratios = (np.exp(centre - face) for face in (upper1, lower1, upper2, lower2))
    upper1, lower1, upper2, lower2 = (ratio[:, :, None] for ratio in ratios)
    return upper1, lower1, upper2, lower2


def _slopes(model: LayDownModel, grid: PhaseSpaceGrid) -> tuple[Array, Array]:
    """∇w/w ≈ −∇B, differences between the faces of a cell; shapes (n1, n2, 1)."""
    d1, d2, _ = grid.spacing
    upper1, lower1, upper2, lower2 = _face_ratios(model, grid)
    return (upper1 - lower1) / d1, (upper2 - lower2) / d2


def _faces_of_angle(grid: PhaseSpaceGrid) -> tuple[Array, Array]:
    """cos α and sin α on the faces across α, times (Δα/2)/sin(Δα/2).

    Shapes (n_alpha + 1,). The first and the last are the same face.
    """
    d_alpha = grid.spacing[2]
    angle = d_alpha * np.arange(grid.shape[2] + 1)
    angle[-1] = 0.0
    scale = 0.5 * d_alpha / np.sin(0.5 * d_alpha)
    return scale * np.cos(angle), scale * np.sin(angle)
