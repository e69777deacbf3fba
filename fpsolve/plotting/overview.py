"""One page that shows a whole run."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from fpsolve.density.solution import Solution
from fpsolve.plotting.angle import draw_angle
from fpsolve.plotting.entropy import draw_entropy, has_entropy
from fpsolve.plotting.maps import N_MAPS, draw_density, draw_row
from fpsolve.plotting.moments import draw_moments
from fpsolve.plotting.selection import check_solution, select_s
from fpsolve.plotting.style import PAGE, drawing, parameters

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["draw_decay", "plot_overview"]


def plot_overview(solution: Solution) -> Figure:
    """Maps of ∫ p dα, the decay of H(p|p_S), the angle, and the spread: one page.

    Parameters
    ----------
    solution : Solution

    Raises
    ------
    ValueError
        If no density was saved.
    """
    check_solution(solution)
    chosen = select_s(solution, None, N_MAPS)
    with drawing(PAGE, 4.6, parameters(solution)) as figure:
        parts: Any = figure.subfigures(2, 1, height_ratios=(1, 1.15))
        maps = {s: solution.marginal("xi", s) for s in chosen}
        draw = partial(draw_density, solution.grid, solution.model)
        draw_row(parts[0], solution.grid, maps, draw)
        panels = parts[1].subplots(1, 3)
        draw_decay(panels[0], solution, "position")
        draw_angle(panels[1], solution, chosen)
        draw_moments(panels[2], solution, "spread")
    return figure


def draw_decay(axes: Axes, solution: Solution, otherwise: str) -> None:
    """Draw the entropy, or moments where there is none."""
    if has_entropy(solution):
        draw_entropy(axes, solution)
    else:
        draw_moments(axes, solution, otherwise)
