"""Steps and grids from the measured error laws, with the reasons in words."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.checks import check_real
from fpsolve.grids.phase_space import PhaseSpaceGrid, check_grid
from fpsolve.model.laydown import LayDownModel, check_model
from fpsolve.model.potentials import Potential
from fpsolve.model.potentials.at_points import gradient_at, value_at
from fpsolve.model.potentials.nodes import GibbsNodes, gibbs_nodes

__all__ = ["SuggestedGrid", "SuggestedStep", "suggest_grid", "suggest_step"]

Array = NDArray[np.float64]

# Upper bounds of ‖p − p_exact‖₁ ≤ C ds², C = 0.4 (1/ℓ² + κ) + 0.18 A²/ℓ, over s ≤ 3ℓ
# and 0.3 ≤ A√ℓ ≤ 10; measured by validation/error_laws.py for patterns of ℓ = 1.
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
# Sizes of the pattern within which the force has to balance the belt.
WIDEST = 1e3
# A deviation this many times the width of one well is that of several.
WELLS = 1 / 0.6
# Cells beyond any machine: 32 GiB for one density.
MOST_CELLS = 2.0**32


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
    """Step ds with C ds² ≤ tolerance, C = 0.4 (1/ℓ² + κ) + 0.18 A²/ℓ, κ = ½ E|∇B|².

    ℓ is the size of the pattern, the power of four nearest the deviation of e^{−B}/Z:
    1 for deviations between 1/2 and 2 (remark 3.1: the law has no unit of its own).

    The law bounds the L1 error of one run of either scheme of order 2 (Strang) over a
    few ℓ of s; with `solve(..., extrapolate=True)` the same step gives a far
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
    length = unit_of_length(model.potential)
    law = splitting_coefficient(model, mean_force, length)
    if not math.isfinite(law):
        raise ValueError(
            "`grid` must resolve exp(-B), got a mean square of the force beyond all "
            "numbers; take more cells, or a smaller `half_width`."
        )
    longest = min(1.0, length)
    finest = 3.0 / max(model.noise * model.noise, 1e-6)
    wanted = min(math.sqrt(tolerance / law), finest, longest)
    ds = 1.0 / math.ceil(1.0 / wanted)
    cell = max(grid.spacing[:2])
    steps = length / ds
    reach = INTERPOLATION_COEFFICIENT * (cell / feature_width(model)) ** 8 * steps
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


def suggest_grid(
    model: LayDownModel,
    tolerance: float = 1e-2,
    *,
    initial: Any = None,
    s_end: float | None = None,
) -> SuggestedGrid:
    """Box and cells for an L1 error of about `tolerance`, from the measured laws.

    The box holds all but a tenth of the tolerance (5e-5 at most) of e^{−B}, all wells
    of it. Where the belt or a nozzle moves, or the start is given, it also holds 8192
    paths and is checked with 8192 others. The cells resolve features half as wide as
    the equilibrium, or its wells, with eight-point interpolation; a narrower start
    needs more. Cells and angles grow as the noise falls.

    Parameters
    ----------
    model : LayDownModel
        Its e^{−B} must be normalisable.
    tolerance : float
    initial : law, optional
        Law of the start from `fpsolve.paths`; e^{−B}/Z by default.
    s_end : float, optional
        Length of the run from the start of the curve; by default long enough for the
        law to settle.

    Returns
    -------
    SuggestedGrid
        A PhaseSpaceGrid; `.reason` says why.

    Raises
    ------
    ValueError
        If the tolerance is not in (0, 1), the potential does not confine, or no box of
        a reasonable size holds the law: paths spread without end, e^{−B} falls like a
        power, or its wells are tiny for their distance.
    """
    check_model(model)
    check_tolerance(tolerance)
    if not model.potential.normalisable:
        raise ValueError(
            f"`potential` must confine, got {model.potential!r}; without a "
            "normalisable exp(-B) no box is large enough, choose one by hand."
        )
    lost = min(BOX_SHARE * tolerance, LARGEST_LOSS)
    nodes = gibbs_nodes(model.potential)
    half_widths, held = box_of(model, nodes, lost, initial, s_end)
    length = unit_of_nodes(nodes)
    law = splitting_coefficient(model, sum(nodes.mean_square_forces()), length)
    step = min(math.sqrt(tolerance / law) / length, 1.0)
    noise = model.noise * math.sqrt(length)
    width = feature_width_of(nodes, noise)
    cell = width * (0.3 * tolerance * step / INTERPOLATION_COEFFICIENT) ** (1 / 8)
    kink = slope_at_origin(model.potential, min(nodes.deviations()))
    if kink > 0:
        cell = min(cell, math.sqrt(0.5 * tolerance / KINK_COEFFICIENT) / kink)
    n1, n2 = (even_cells(2 * half / cell) for half in half_widths)
    n_alpha = angles_for(noise)
    check_size(n1, n2, n_alpha, half_widths, width)
    reason = (
        f"half widths {half_widths[0]:g} and {half_widths[1]:g} {held}; cells of "
        f"{cell:.2g} resolve features of width {width:.2g} with eight-point "
        f"interpolation; {n_alpha} angles suit A = {model.noise:g}"
    )
    if kink > 0:
        reason += f"; the kink of slope {kink:.2g} at the origin limits the cells"
    reason += "."
    return SuggestedGrid.because(half_widths, (n1, n2, n_alpha), reason)


def box_of(
    model: LayDownModel,
    nodes: GibbsNodes,
    lost: float,
    initial: Any,
    s_end: float | None,
) -> tuple[tuple[float, float], str]:
    """Half widths of a box that holds the law, and what they leave outside."""
    if not nodes.unknown < lost / 2:
        raise ValueError(
            f"`potential` must fall fast enough for a box, got {model.potential!r}: "
            f"a share of {nodes.unknown:.2g} of exp(-B) lies farther out than 1e8; "
            "choose a box by hand."
        )
    half1, half2 = nodes.half_widths(lost)
    if model.curve.fixed and initial is None:
        half_widths = rounded_up(half1), rounded_up(half2)
        if nodes.outside(half_widths) > lost:
            half1, half2 = nodes.half_widths(lost / 2)
            half_widths = rounded_up(half1), rounded_up(half2)
        outside = nodes.outside(half_widths)
        return half_widths, f"leave {outside:.1e} of exp(-B) outside"
    # Paths are an oracle: the solver does not know them, and loads them for this only.
    from fpsolve.studies.boxes import box_for_travel

    shift = belt_shift(model)
    travel = box_for_travel(model, nodes, (half1 + shift, half2), lost, initial, s_end)
    belt = "" if model.curve.fixed else f", belt shift {shift:.2g}"
    held = f"leave less than {lost:.1g} outside ({travel.text}{belt})"
    return travel.half_widths, held


def check_size(
    n1: int, n2: int, n_alpha: int, half_widths: tuple[float, float], width: float
) -> None:
    """Raise if the grid is beyond any machine."""
    if not float(n1) * n2 * n_alpha <= MOST_CELLS:
        raise ValueError(
            f"`model` must have a pattern that a grid can hold, got features of width "
            f"{width:.2g} in a box of half widths {half_widths[0]:g} and "
            f"{half_widths[1]:g}: {n1} x {n2} x {n_alpha} cells; move the minimum of B "
            "to the origin, or choose a grid by hand."
        )


def check_tolerance(tolerance: float) -> None:
    """Raise unless 0 < tolerance < 1."""
    tolerance = check_real("tolerance", tolerance)
    if not 0 < tolerance < 1:
        raise ValueError(
            f"`tolerance` must lie between 0 and 1, got {tolerance:g}; it is an L1 "
            "error of a probability density."
        )


def splitting_coefficient(
    model: LayDownModel, mean_force: float, length: float = 1.0
) -> float:
    """C of the splitting error C ds², for a pattern of the given size."""
    spread = NOISE_COEFFICIENT * model.noise * model.noise / length
    return FORCE_COEFFICIENT * (1 / length**2 + mean_force / 2) + spread


def unit_of_length(potential: Potential) -> float:
    """ℓ of the error laws: 1 for a potential that has no pattern."""
    return unit_of_nodes(gibbs_nodes(potential)) if potential.normalisable else 1.0


def unit_of_nodes(nodes: GibbsNodes) -> float:
    """The power of four nearest the smaller deviation, so that scaling is exact."""
    deviation = min(nodes.deviations())
    return 4.0 ** round(math.log(deviation, 4.0)) if deviation > 0 else 1.0


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
    if not model.potential.normalisable:
        return FEATURE * narrowing(model.noise)
    nodes = gibbs_nodes(model.potential)
    return feature_width_of(nodes, model.noise * math.sqrt(unit_of_nodes(nodes)))


def feature_width_of(nodes: GibbsNodes, noise: float) -> float:
    """The same; of one well where there are several, of the wall where it is steep.

    The noise is A√ℓ, without dimension.
    """
    widths = [
        deviation if deviation < WELLS / math.sqrt(force) else 1 / math.sqrt(force)
        for deviation, force in zip(
            nodes.deviations(), nodes.mean_square_forces(), strict=True
        )
    ]
    return FEATURE * narrowing(noise) * min(widths)


def narrowing(noise: float) -> float:
    """What little noise makes of the width of a feature."""
    return min(1.0, math.pow(max(noise, LEAST_NOISE), FILAMENTS))


def box_half_widths(potential: Potential, lost: float) -> tuple[float, float]:
    """Half widths outside which e^{−B} has the share `lost`, direction by direction."""
    return gibbs_nodes(potential).half_widths(lost)


def belt_shift(model: LayDownModel) -> float:
    """Where the belt moves the mean of ξ1: |∂₁B| = A²k/2 with I₁(k)/I₀(k) = v.

    From where B is lowest along the belt; zero where the force never gets that strong.
    """
    from scipy.optimize import brentq
    from scipy.special import i0e, i1e

    speed = abs(model.belt_speed)
    if speed == 0:
        return 0.0
    # At twice 1/(1 − v) the ratio 1 − 1/(2k) − … is beyond v.
    opening = float(brentq(lambda k: i1e(k) / i0e(k) - speed, 0.0, 2 / (1 - speed)))
    force = 0.5 * model.noise * model.noise * opening

    def excess(x: float) -> float:
        return float(model.potential.gradient(x, 0.0)[0]) - force

    widest = WIDEST * unit_of_length(model.potential)
    centre = 0.0
    if float(model.potential.gradient(0.0, 0.0)[0]) != 0:
        centre = lowest_on_belt(model.potential, widest)
    if not excess(centre) < 0 < excess(widest):
        return 0.0
    xtol = 2e-12 * widest / WIDEST
    return float(brentq(excess, centre, widest, xtol=xtol)) - centre


def lowest_on_belt(potential: Potential, widest: float) -> float:
    """About where B is lowest along ξ2 = 0."""
    places = np.linspace(-widest, widest, 20001)
    return float(places[np.argmin(potential.value(places, 0.0))])


def slope_at_origin(potential: Potential, length: float) -> float:
    """|∇B| just off the origin of an isotropic potential, zero if B is smooth there.

    `length` is the size of the pattern, on which B changes by about one.
    """
    if not potential.isotropic:
        return 0.0
    slope = float(np.hypot(*potential.gradient(1e-6 * length, 0.0)))
    return slope if slope * length > 1e-3 else 0.0


def angles_for(noise: float) -> int:
    """Angles whose error stays below that of the interpolation.

    Measured for B = |ξ|²/2 by validation/error_laws.py: 24 angles leave 3e-7 at
    A = 1, 48 leave 5e-5 at A = 0.3; below, the density filaments in α as in ξ.
    """
    return 32 if noise >= 1 else 64 if noise >= 0.3 else 128


def rounded_up(half_width: float) -> float:
    """To the next eighth of the power of two below: 4.1 becomes 4.5, 0.041 0.0469."""
    step = 2.0 ** (math.floor(math.log2(half_width)) - 3)
    return math.ceil(half_width / step) * step


def even_cells(number: float) -> int:
    """Next multiple of eight, at least sixteen."""
    return max(16, 8 * math.ceil(number / 8))
