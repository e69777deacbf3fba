"""Marginal densities of the angle."""

from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import cycle
from typing import TYPE_CHECKING

import numpy as np

from fpsolve.density.solution import Solution
from fpsolve.plotting.selection import check_solution, select_s
from fpsolve.plotting.style import COLOURS, COLUMN, LINES, drawing, parameters

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["draw_angle", "draw_uniform", "plot_angle", "show_turn"]

_MOST_LINES = 6
_LINE_STYLES = ("-", "--", "-.", ":", (0, (5, 1)), (0, (1, 1)))


def plot_angle(solution: Solution, at: Iterable[float] | None = None) -> Figure:
    """∫ p dξ over the angle α at several s, with the uniform density 1/(2π).

    Parameters
    ----------
    solution : Solution
    at : iterable of float, optional
        Saved arclengths to show; by default all, at most six of them.

    Raises
    ------
    ValueError
        If no density was saved, or none at one of the arclengths.
    """
    check_solution(solution)
    with drawing(COLUMN, 2.6, parameters(solution)) as figure:
        draw_angle(figure.subplots(), solution, select_s(solution, at, _MOST_LINES))
    return figure


def draw_angle(axes: Axes, solution: Solution, chosen: list[float]) -> None:
    """Draw α marginals at the chosen arclengths into one panel."""
    alpha = solution.grid.alpha
    # One cell more on either side, so that the lines reach 0 and 2π.
    cells = np.arange(-1, alpha.size + 1)
    periodic = alpha[0] + cells * solution.grid.spacing[2]
    looks = zip(cycle(LINES), cycle(_LINE_STYLES), strict=True)
    for s, (colour, style) in zip(chosen, looks, strict=False):
        values = np.take(solution.marginal("alpha", s), cells, mode="wrap")
        axes.plot(periodic, values, color=colour, ls=style, label=f"$s = {s:g}$")
    draw_uniform(axes)
    show_turn(axes)
    highest = max(float(np.max(line.get_ydata())) for line in axes.lines)
    axes.set_ylim(min(0.0, axes.get_ylim()[0]), 1.08 * highest)
    axes.legend()


def draw_uniform(axes: Axes) -> None:
    """Draw the density that is the same for every angle, and name both axes."""
    uniform = 1 / (2 * math.pi)
    axes.axhline(uniform, color=COLOURS["black"], linewidth=0.8, label=r"$1/(2\pi)$")
    axes.set(xlabel=r"angle $\alpha$", ylabel=r"$\int p\;\mathrm{d}\xi$")


def show_turn(axes: Axes) -> None:
    """Show angles from 0 to 2π, with quarters of a turn as ticks."""
    axes.set_xlim(0, 2 * math.pi)
    names = ["0", r"$\pi/2$", r"$\pi$", r"$3\pi/2$", r"$2\pi$"]
    axes.set_xticks(np.arange(5) * math.pi / 2, names)
