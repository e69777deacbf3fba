"""A grid from the measured error laws, with the reasons in words, its box checked."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, cast

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.density.error_laws import (
    INTERPOLATION_COEFFICIENT,
    KINK_COEFFICIENT,
    angles_for,
    feature_width_of,
    slope_at_origin,
    splitting_coefficient,
    unit_of_length,
    unit_of_nodes,
)  # fmt: skip
from fpsolve.density.suggestions import check_tolerance
from fpsolve.grids.initial import equilibrium, gaussian
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.smooth import SmoothPhaseSpaceGrid
from fpsolve.model.fibre import FibreModel, check_fibre_model
from fpsolve.model.laydown import LayDownModel, check_model
from fpsolve.model.potentials.nodes import GibbsNodes, gibbs_nodes
from fpsolve.model.potentials.potential import Potential
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.paths.laws import EquilibriumLaw, GaussianLaw
from fpsolve.studies.boxes import box_for_travel, rounded_up
from fpsolve.studies.explained_grid import (
    SuggestedGrid,
    check_normalisable,
    share_outside,
)
from fpsolve.studies.fourier_grid import suggest_fourier_grid

__all__ = ["SuggestedSmoothGrid", "suggest_grid"]

# Sizes of the pattern within which the force has to balance the belt.
WIDEST = 1e3
# Half width of the curvature in its deviations √E κ², and cells in κ over √(A²/2R).
DEVIATIONS, CURVATURE_CELL = 6.0, 0.6
TRANSLATIONS = ("lagrange", "fourier")
# Cells beyond any machine: 32 GiB for one density.
MOST_CELLS = 2.0**32


class SuggestedSmoothGrid(SmoothPhaseSpaceGrid):
    """A grid with a curvature that knows why: with a `reason`.

    Attributes
    ----------
    reason : str
        What set the box, the range of κ and each number of cells.
    """

    reason: str

    @classmethod
    def of(
        cls, grid: SuggestedGrid, model: SmoothLayDownModel, curvature: float
    ) -> SuggestedSmoothGrid:
        """The grid of (ξ, α) with a range for curvatures of that deviation."""
        deviation = math.sqrt(model.curvature_variance)
        half_width = DEVIATIONS * max(curvature, deviation)
        n_kappa = 2 * math.ceil(half_width / (CURVATURE_CELL * deviation))
        n1, n2, n_alpha = grid.shape
        curved = cls(grid.half_width, half_width, (n1, n2, n_alpha, n_kappa))
        reason = (
            f"{grid.reason} |κ| < {half_width:.3g} are {DEVIATIONS:g} times √E κ² = "
            f"{curvature:.3g}, and {n_kappa} cells resolve the Gaussian of deviation "
            f"{deviation:.3g}."
        )
        object.__setattr__(curved, "reason", reason)
        return curved


def suggest_grid(
    model: FibreModel,
    tolerance: float = 1e-2,
    *,
    initial: Any = None,
    s_end: float | None = None,
    translation: str = "lagrange",
) -> SuggestedGrid | SuggestedSmoothGrid:
    """Box and cells for an L1 error of about `tolerance`, by measured laws or trials.

    The box holds all but a tenth of the tolerance (5e-5 at most) of e^{−B}, all wells
    of it. Where the belt or a nozzle moves, or the start is given, it also holds 8192
    paths and is checked with 8192 others, as always for smooth fibres, which stray
    farther than e^{−B} says; their curvatures reach six times √E κ². The cells resolve
    features half as wide as the equilibrium, or its wells, with eight-point
    interpolation; a narrower start needs more. Cells and angles grow as the noise
    falls.

    With ``translation="fourier"`` no law with one exponent says how many cells are
    enough: trial runs of the start do, see `suggest_fourier_grid`.

    Parameters
    ----------
    model : LayDownModel or SmoothLayDownModel
        Its e^{−B} must be normalisable.
    tolerance : float
    initial : law, or with Fourier translations a callable, optional
        Law of the start from `fpsolve.paths`, e^{−B}/Z by default; or
        ``initial(grid)``, the start on any grid.
    s_end : float, optional
        Length of the run from the start of the curve; by default long enough for the
        law to settle. Fourier translations need one.
    translation : {"lagrange", "fourier"}
        How the scheme will translate.

    Returns
    -------
    SuggestedGrid or SuggestedSmoothGrid
        A PhaseSpaceGrid, or a SmoothPhaseSpaceGrid; `.reason` says why.

    Raises
    ------
    ValueError
        If the tolerance is not in (0, 1), the potential does not confine, or no box of
        a reasonable size holds the law: paths spread without end, e^{−B} falls like a
        power, or its wells are tiny for their distance. For Fourier translations also
        if the start is too sharp.
    TypeError
        If the start is neither a law nor a callable, or Fourier translations are asked
        for a smooth model.
    """
    check_fibre_model(model)
    if translation not in TRANSLATIONS:
        raise ValueError(
            f'`translation` must be "lagrange" or "fourier", got {translation!r}.'
        )
    if translation == "fourier":
        return grid_by_trials(model, tolerance, initial, s_end)
    check_tolerance(tolerance)
    check_normalisable(model)
    lost = share_outside(tolerance)
    nodes = gibbs_nodes(model.potential)
    smooth = isinstance(model, SmoothLayDownModel)
    if smooth and not model.noise > 0:
        raise ValueError(
            "`noise` must be positive for a density of the curvature, got 0: without "
            "noise κ is a function of the path; follow it with `sample_paths`."
        )
    half_widths, held, curvature = box_of(model, nodes, lost, initial, s_end)
    length = unit_of_nodes(nodes)
    basic: Any = getattr(model, "white_noise_limit", model)
    law = splitting_coefficient(basic, sum(nodes.mean_square_forces()), length)
    step = min(math.sqrt(tolerance / law) / length, 1.0)
    noise = model.noise * math.sqrt(length)
    width = feature_width_of(nodes, noise)
    # One interpolation of order eight at every step: 1/step of them in a unit of s may
    # take three tenths of the tolerance.
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
    grid = SuggestedGrid.because(half_widths, (n1, n2, n_alpha), reason)
    if isinstance(model, SmoothLayDownModel):
        return SuggestedSmoothGrid.of(grid, model, curvature)
    return grid


def grid_by_trials(
    model: FibreModel, tolerance: float, initial: Any, s_end: float | None
) -> SuggestedGrid:
    """The grid for Fourier translations of a start that a law or a callable says."""
    check_model(model)
    basic = cast(LayDownModel, model)
    if s_end is None:
        raise ValueError(
            "`s_end` must be given for Fourier translations, got none: the cells are "
            "chosen by trial runs of that length."
        )
    start = starter(initial, basic.potential)
    return suggest_fourier_grid(basic, start, s_end, tolerance)


def starter(initial: Any, potential: Potential) -> Callable[[PhaseSpaceGrid], Array]:
    """A callable that puts a start on any grid."""
    if initial is None or isinstance(initial, EquilibriumLaw):
        target = potential if initial is None else initial.potential
        return lambda grid: equilibrium(grid, target)
    if isinstance(initial, GaussianLaw):
        return lambda grid: gaussian(
            grid, initial.mean, initial.variance, initial.angle, initial.concentration
        )
    if not callable(initial):
        raise TypeError(
            "`initial` must be a GaussianLaw, an EquilibriumLaw or a function of the "
            f"grid for Fourier translations, got {type(initial).__name__}."
        )
    return cast(Callable[[PhaseSpaceGrid], Array], initial)


def box_of(
    model: FibreModel,
    nodes: GibbsNodes,
    lost: float,
    initial: Any,
    s_end: float | None,
) -> tuple[tuple[float, float], str, float]:
    """Half widths of a box that holds the law, what they leave outside, and √E κ²."""
    if not nodes.unknown < lost / 2:
        raise ValueError(
            f"`potential` must fall fast enough for a box, got {model.potential!r}: "
            f"a share of {nodes.unknown:.2g} of exp(-B) lies farther out than 1e8; "
            "choose a box by hand."
        )
    half1, half2 = nodes.half_widths(lost)
    smooth = isinstance(model, SmoothLayDownModel)
    if model.curve.fixed and initial is None and not smooth:
        half_widths = rounded_up(half1), rounded_up(half2)
        if nodes.outside(half_widths) > lost:
            half1, half2 = nodes.half_widths(lost / 2)
            half_widths = rounded_up(half1), rounded_up(half2)
        outside = nodes.outside(half_widths)
        return half_widths, f"leave {outside:.1e} of exp(-B) outside", 0.0
    shift = belt_shift(model)
    travel = box_for_travel(model, nodes, (half1 + shift, half2), lost, initial, s_end)
    belt = "" if model.curve.fixed else f", belt shift {shift:.2g}"
    held = f"leave less than {lost:.1g} outside ({travel.text}{belt})"
    return travel.half_widths, held, travel.curvature


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


def belt_shift(model: FibreModel) -> float:
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


def even_cells(number: float) -> int:
    """Next multiple of eight, at least sixteen."""
    return max(16, 8 * math.ceil(number / 8))
