"""One page that shows a whole run."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fpsolve.density.solution import Solution
from fpsolve.plotting.angle import draw_angle
from fpsolve.plotting.entropy import draw_entropy, has_entropy
from fpsolve.plotting.maps import (
    add_colour_bar,
    colour_scale,
    draw_map,
    show_region,
    visible_region,
)
from fpsolve.plotting.moments import draw_moments
from fpsolve.plotting.selection import check_solution, select_s
from fpsolve.plotting.style import PAGE, new_figure, paper_style, parameters

if TYPE_CHECKING:
    from matplotlib.figure import Figure, SubFigure

__all__ = ["plot_overview"]

_N_MAPS = 4


def plot_overview(solution: Solution) -> Figure:
    """Maps of ∫ p dα, the decay of H(p|p_S), the angle, and the spread: one page.

    Parameters
    ----------
    solution : Solution

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ValueError
        If no density was saved.
    """
    check_solution(solution)
    chosen = select_s(solution, None, _N_MAPS)
    with paper_style():
        figure = new_figure(PAGE, 4.6)
        parts: Any = figure.subfigures(2, 1, height_ratios=(1, 1.15))
        upper, lower = parts
        _draw_maps(upper, solution, chosen)
        panels = lower.subplots(1, 3)
        if has_entropy(solution):
            draw_entropy(panels[0], solution)
        else:
            draw_moments(panels[0], solution, "position")
        draw_angle(panels[1], solution, chosen)
        draw_moments(panels[2], solution, "spread")
        figure.suptitle(parameters(solution))
    return figure


def _draw_maps(figure: SubFigure, solution: Solution, chosen: list[float]) -> None:
    maps = [solution.marginal("xi", s) for s in chosen]
    panels = figure.subplots(1, _N_MAPS, sharey=True)
    for axes in panels[len(maps) :]:
        axes.set_axis_off()
    scale, region = colour_scale(maps), visible_region(solution, maps)
    for axes, s, values in zip(panels, chosen, maps, strict=False):
        image = draw_map(axes, solution, values, scale)
        axes.set_title(f"$s = {s:g}$")
        axes.set_xlabel(r"$\xi_1$")
        show_region(axes, region)
    panels[0].set_ylabel(r"$\xi_2$")
    add_colour_bar(figure, image, list(panels[: len(maps)]))
