"""Steps and grids from the measured error laws, with the reasons in words."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fpsolve._checks import check_real
from fpsolve.grids import PhaseSpaceGrid, check_grid
from fpsolve.models import LayDownModel, check_model
from fpsolve.potentials import Potential
from fpsolve.potentials.at_points import gradient_at, value_at

__all__ = ["SuggestedGrid", "SuggestedStep", "suggest_grid", "suggest_step"]

Array = NDArray[np.float64]

# Upper bounds of ‖p − p_exact‖₁ ≤ C ds², C = 0.4 (1 + κ) + 0.18 A², over s ≤ 3 and
# 0.3 ≤ A ≤ 10; measured by validation/error_laws.py.
FORCE_COEFFICIENT = 0.4
NOISE_COEFFICIENT = 0.18
# ‖error‖₁ ≤ 0.06 (Δξ/w)⁸ / ds of eight-point interpolation, for a density whose
# narrowest feature has standard deviation w.
INTERPOLATION_COEFFICIENT = 0.06
# ‖error‖₁ ≤ 0.2 (K Δξ)² where |∇B| jumps at the origin to K, as for B = K|ξ|: the
# kink lowers the order of every scheme to two there.
KINK_COEFFICIENT = 0.2
# A start half as wide as the equilibrium, as in the examples; with little noise the
# density filaments and features become narrower, by A^0.35 at s = 3.
FEATURE = 0.5
FILAMENTS = 0.35
LEAST_NOISE = 0.05
# Share of the tolerance spent on what the box cuts off; never so much that the
# boundary mass would stop a run at its default tolerance of 1e-3.
BOX_SHARE = 0.1
LARGEST_LOSS = 5e-5
SAMPLES = 256
WIDEST = 1e3


class SuggestedStep(float):
    """A step ds that knows why: a float with a `reason`.

    Attributes
    ----------
    reason : str
        The error law, its numbers, and what else limits the step.
    """

    reason: str

    def __new__(cls, ds: float, reason: str) -> SuggestedStep:
        """Make a step with its reason."""
        step = super().__new__(cls, ds)
        step.reason = reason
        return step

    def __getnewargs__(self) -> tuple[float, str]:  # type: ignore[override]
        return float(self), self.reason


class SuggestedGrid(PhaseSpaceGrid):
    """A grid that knows why: a PhaseSpaceGrid with a `reason`.

    Attributes
    ----------
    reason : str
        What set the box and each number of cells.
    """

    reason: str

    @classmethod
    def because(
        cls, half_width: tuple[float, float], shape: tuple[int, int, int], reason: str
    ) -> SuggestedGrid:
        """The grid with its reason."""
        grid = cls(half_width, shape)
        object.__setattr__(grid, "reason", reason)
        return grid


def suggest_step(
    model: LayDownModel, grid: PhaseSpaceGrid, tolerance: float = 1e-2
) -> SuggestedStep:
    """Step ds with C ds² ≤ tolerance, C = 0.4 (1 + κ) + 0.18 A², κ = ½ ∫|∇B|² e^{−B}/Z.

    The law bounds the L1 error of one run of either scheme of order 2 (Strang) over a
    few units of s; with `solve(..., extrapolate=True)` the same step gives a far
    smaller error and an estimate of it. Large noise is thereby resolved as well
    (ds ≤ 3/A²). The step is 1/m with an integer m, so that it divides whole spans.

    Parameters
    ----------
    model : LayDownModel
    grid : PhaseSpaceGrid
        Tells where the force is averaged, and whether the interpolation keeps up.
    tolerance : float
        L1 error to aim at.

    Returns
    -------
    SuggestedStep
        A float; `.reason` says why.
    """
    check_model(model)
    check_grid(grid)
    check_tolerance(tolerance)
    mean_force = mean_square_force(model, grid)
    law = splitting_coefficient(model, mean_force)
    if not math.isfinite(law):
        raise ValueError(
            "`grid` must resolve exp(-B), got a mean square of the force beyond all "
            "numbers; take more cells, or a smaller `half_width`."
        )
    wanted = min(math.sqrt(tolerance / law), 3.0 / max(model.noise, 1e-3) ** 2, 1.0)
    ds = 1.0 / math.ceil(1.0 / wanted)
    cell = max(grid.spacing[:2])
    reach = INTERPOLATION_COEFFICIENT * (cell / feature_width(model)) ** 8 / ds
    reason = (
        f"the splitting error is at most {law:.2g} ds² (κ = {mean_force / 2:.2g}, "
        f"A = {model.noise:g}), so ds = {ds:.3g} keeps it below {tolerance:g}"
    )
    if reach > tolerance:
        reason += (
            f"; the cells of {cell:.3g} are too coarse for that: the interpolation "
            f"error is about {reach:.1g}, refine the grid"
        )
    return SuggestedStep(ds, reason + ".")


def suggest_grid(model: LayDownModel, tolerance: float = 1e-2) -> SuggestedGrid:
    """Box and cells for an L1 error of about `tolerance`, from the measured laws.

    The box holds all of e^{−B} but a tenth of the tolerance (5e-5 at most), moved by
    the belt: |∇B| = A²k/2 with I₁(k)/I₀(k) = v, from E cos α = −v. The cells resolve
    features half as wide as the equilibrium with eight-point interpolation; a
    narrower start needs more. Cells and angles grow as the noise falls.

    Parameters
    ----------
    model : LayDownModel
        Its e^{−B} must be normalisable.
    tolerance : float

    Returns
    -------
    SuggestedGrid
        A PhaseSpaceGrid; `.reason` says why.

    Raises
    ------
    ValueError
        If the tolerance is not in (0, 1) or the potential does not confine.
    """
    check_model(model)
    check_tolerance(tolerance)
    if not model.potential.normalisable:
        raise ValueError(
            f"`potential` must confine, got {model.potential!r}; without a "
            "normalisable exp(-B) no box is large enough, choose one by hand."
        )
    lost = min(BOX_SHARE * tolerance, LARGEST_LOSS)
    shift = belt_shift(model)
    half1, half2 = box_half_widths(model.potential, lost)
    half_widths = (round_up(half1 + shift), round_up(half2))
    coarse = PhaseSpaceGrid(half_widths, (SAMPLES, SAMPLES, 4))
    law = splitting_coefficient(model, mean_square_force(model, coarse))
    ds = min(math.sqrt(tolerance / law), 1.0)
    width = feature_width(model)
    cell = width * (0.3 * tolerance * ds / INTERPOLATION_COEFFICIENT) ** (1 / 8)
    kink = slope_at_origin(model.potential)
    if kink > 0:
        cell = min(cell, math.sqrt(0.5 * tolerance / KINK_COEFFICIENT) / kink)
    n1, n2 = (even_cells(2 * half / cell) for half in half_widths)
    n_alpha = angles_for(model.noise)
    reason = (
        f"half widths {half_widths[0]:g} and {half_widths[1]:g} leave less than "
        f"{lost:.1g} of exp(-B) outside (belt shift {shift:.2g}); cells of "
        f"{cell:.2g} resolve features of width {width:.2g} with eight-point "
        f"interpolation; {n_alpha} angles suit A = {model.noise:g}"
    )
    if kink > 0:
        reason += f"; the kink of slope {kink:.2g} at the origin limits the cells"
    reason += "."
    return SuggestedGrid.because(half_widths, (n1, n2, n_alpha), reason)


def check_tolerance(tolerance: float) -> None:
    """Raise unless 0 < tolerance < 1."""
    tolerance = check_real("tolerance", tolerance)
    if not 0 < tolerance < 1:
        raise ValueError(
            f"`tolerance` must lie between 0 and 1, got {tolerance:g}; it is an L1 "
            "error of a probability density."
        )


def splitting_coefficient(model: LayDownModel, mean_force: float) -> float:
    """C of the splitting error C ds²."""
    spread = NOISE_COEFFICIENT * model.noise * model.noise
    return FORCE_COEFFICIENT * (1 + mean_force / 2) + spread


def mean_square_force(model: LayDownModel, grid: PhaseSpaceGrid) -> float:
    """∫ |∇B|² e^{−B} dξ / ∫ e^{−B} dξ on the grid."""
    xi1, xi2 = grid.plane()
    potential = value_at(model.potential, xi1, xi2)
    force1, force2 = gradient_at(model.potential, xi1, xi2)
    weight = np.exp(potential.min() - potential)
    with np.errstate(over="ignore"):
        # A square that overflows counts only where there is weight.
        squared = np.where(weight > 0, force1**2 + force2**2, 0.0)
        return float((weight * squared).sum() / weight.sum())


def feature_width(model: LayDownModel) -> float:
    """Half the smaller standard deviation of e^{−B}, less where noise is small."""
    narrowing = min(1.0, math.pow(max(model.noise, LEAST_NOISE), FILAMENTS))
    if not model.potential.normalisable:
        return FEATURE * narrowing
    xi1, xi2, weight = sampled(model.potential)
    variances = float((weight * xi1**2).sum()), float((weight * xi2**2).sum())
    return FEATURE * narrowing * math.sqrt(min(variances))


def sampled(potential: Potential) -> tuple[Array, Array, Array]:
    """Cell centres of a box that holds e^{−B} and its normalised weights on them."""
    half = 1.0
    while edge_share(potential, half) > 1e-6 and half < WIDEST:
        half *= 1.5
    grid = PhaseSpaceGrid(half, (SAMPLES, SAMPLES, 4))
    xi1, xi2 = grid.plane()
    value = potential.value(xi1, xi2)
    weight = np.exp(value.min() - value)
    return xi1, xi2, weight / weight.sum()


def edge_share(potential: Potential, half: float) -> float:
    """Largest e^{−B} on the edge of a box relative to the largest inside."""
    line = np.linspace(-half, half, SAMPLES)
    inside = np.asarray(potential.value(line[:, None], line[None, :]))
    edges = (inside[0], inside[-1], inside[:, 0], inside[:, -1])
    lowest = min(float(edge.min()) for edge in edges)
    return math.exp(min(float(inside.min()) - lowest, 0.0))


def box_half_widths(potential: Potential, lost: float) -> tuple[float, float]:
    """Half widths outside which e^{−B} has the share `lost`, direction by direction."""
    xi1, xi2, weight = sampled(potential)
    widths = []
    for axis, places in ((1, xi1.ravel()), (0, xi2.ravel())):
        order = np.argsort(np.abs(places))
        inside = np.cumsum(weight.sum(axis=axis)[order])
        enough = int(np.searchsorted(inside, 1 - lost))
        widths.append(float(np.abs(places[order][min(enough, places.size - 1)])))
    return widths[0], widths[1]


def belt_shift(model: LayDownModel) -> float:
    """Where the belt moves the mean of ξ1: |∂₁B| = A²k/2 with I₁(k)/I₀(k) = v."""
    from scipy.optimize import brentq
    from scipy.special import i0e, i1e

    speed = abs(model.belt_speed)
    if speed == 0:
        return 0.0
    opening = float(brentq(lambda k: i1e(k) / i0e(k) - speed, 0.0, 1e6))
    force = 0.5 * model.noise * model.noise * opening

    def excess(x: float) -> float:
        return float(model.potential.gradient(x, 0.0)[0]) - force

    return float(brentq(excess, 0.0, WIDEST)) if excess(WIDEST) > 0 else 0.0


def slope_at_origin(potential: Potential) -> float:
    """|∇B| just off the origin of an isotropic potential, zero if B is smooth there."""
    if not potential.isotropic:
        return 0.0
    slope = float(np.hypot(*potential.gradient(1e-6, 0.0)))
    return slope if slope > 1e-3 else 0.0


def angles_for(noise: float) -> int:
    """Angles whose error stays below that of the interpolation.

    Measured for B = |ξ|²/2 by validation/error_laws.py: 24 angles leave 3e-7 at
    A = 1, 48 leave 5e-5 at A = 0.3; below, the density filaments in α as in ξ.
    """
    return 32 if noise >= 1 else 64 if noise >= 0.3 else 128


def round_up(half_width: float) -> float:
    """To the next half."""
    return math.ceil(2 * half_width) / 2


def even_cells(number: float) -> int:
    """Next multiple of eight, at least sixteen."""
    return max(16, 8 * math.ceil(number / 8))
