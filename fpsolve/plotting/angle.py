"""Marginal densities of the angle."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from fpsolve.density.solution import Solution
from fpsolve.plotting.selection import check_solution, select_s
from fpsolve.plotting.style import COLOURS, COLUMN, new_figure, paper_style, parameters

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["draw_angle", "plot_angle"]

_MOST_LINES = 6
_LINE_STYLES = ("-", "--", "-.", ":", (0, (5, 1)), (0, (1, 1)))


def plot_angle(solution: Solution, at: Iterable[float] | None = None) -> Figure:
    """∫ p dξ over the angle α at several s, with the uniform density 1/(2π).

    Parameters
    ----------
    solution : Solution
    at : iterable of float, optional
        Saved arclengths to show; by default all, at most six of them.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ValueError
        If no density was saved, or none at one of the arclengths.
    """
    check_solution(solution)
    with paper_style():
        figure = new_figure(COLUMN, 2.6)
        axes = figure.subplots()
        draw_angle(axes, solution, select_s(solution, at, _MOST_LINES))
        figure.suptitle(parameters(solution))
    return figure


def draw_angle(axes: Axes, solution: Solution, chosen: list[float]) -> None:
    """Draw α marginals at the chosen arclengths into one panel."""
    alpha = solution.grid.alpha
    # One cell more on either side, so that the lines reach 0 and 2π.
    cells = np.arange(-1, alpha.size + 1)
    periodic = alpha[0] + cells * solution.grid.spacing[2]
    colours = [COLOURS[name] for name in COLOURS if name != "black"]
    for index, s in enumerate(chosen):
        values = np.take(solution.marginal("alpha", s), cells, mode="wrap")
        axes.plot(
            periodic,
            values,
            color=colours[index % len(colours)],
            linestyle=_LINE_STYLES[index % len(_LINE_STYLES)],
            label=f"$s = {s:g}$",
        )
    axes.axhline(
        1 / (2 * math.pi), color=COLOURS["black"], linewidth=0.8, label=r"$1/(2\pi)$"
    )
    axes.set_xlim(0, 2 * math.pi)
    axes.set_xticks(
        np.arange(5) * math.pi / 2,
        ["0", r"$\pi/2$", r"$\pi$", r"$3\pi/2$", r"$2\pi$"],
    )
    highest = max(float(np.max(line.get_ydata())) for line in axes.lines)
    axes.set_ylim(min(0.0, axes.get_ylim()[0]), 1.08 * highest)
    axes.set_xlabel(r"angle $\alpha$")
    axes.set_ylabel(r"$\int p\;\mathrm{d}\xi$")
    axes.legend()
