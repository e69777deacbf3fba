"""What many paths say together: histograms and moments with their standard errors."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from fpsolve.density.solution import Solution
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.plotting.maps import (
    add_colour_bar,
    colour_scale,
    draw_map,
    show_region,
    visible_region,
)
from fpsolve.plotting.moments import PANELS, draw_moments
from fpsolve.plotting.selection import check_paths
from fpsolve.plotting.style import COLOURS, PAGE, new_figure, paper_style, parameters

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, FigureBase

    from fpsolve.paths.histogram import Histogram
    from fpsolve.paths.moments import Moments
    from fpsolve.paths.result import Paths

__all__ = ["plot_ensemble"]

# Cells of a histogram that the figure counts itself.
_SHAPE = (40, 40, 32)
# Points that are this few are marked, so that one alone is seen.
_FEW = 12


def plot_ensemble(paths: Paths, s: float | None = None) -> Figure:
    """Histograms of ξ and α at s, and E and Var of ξ and τ(α) with standard errors.

    White contours enclose 95 % (dashed) and 50 % of p_S, which is uniform in α. The
    bars of the angle's histogram and the bands of the moments are one standard error.

    Parameters
    ----------
    paths : Paths
        With positions kept, or a histogram collected while sampling; without either
        the moments alone are shown. With one saved arclength the histograms alone
        are.
    s : float, optional
        Saved arclength of the histograms; by default the last.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ValueError
        If nothing was saved at `s`.
    """
    check_paths(paths)
    histogram = _histogram(paths, s)
    with paper_style():
        if histogram is None:
            figure = new_figure(PAGE, 2.6)
            _draw_moments(figure.subplots(1, 3), paths)
        elif len(paths.s) == 1:
            figure = new_figure(PAGE, 2.8)
            _draw_histograms(figure, paths, histogram)
        else:
            figure = new_figure(PAGE, 4.9)
            parts: Any = figure.subfigures(2, 1, height_ratios=(1.15, 1))
            _draw_histograms(parts[0], paths, histogram)
            _draw_moments(parts[1].subplots(1, 3), paths)
        figure.suptitle(_title(paths))
    return figure


def _histogram(paths: Paths, s: float | None) -> Histogram | None:
    """Return the counts collected while sampling, or else of the kept positions."""
    if paths.ensemble.grid is not None:
        return paths.histogram(s=s)
    return paths.histogram(_fitting_grid(paths), s) if paths.kept else None


def _fitting_grid(paths: Paths) -> PhaseSpaceGrid:
    """Return a box around the origin in which all saved positions lie."""
    farthest = np.abs(paths.xi).max(axis=(0, 1))
    width1, width2 = (1.001 * float(one) if one > 0 else 1.0 for one in farthest)
    return PhaseSpaceGrid((width1, width2), _SHAPE)


def _draw_histograms(figure: FigureBase, paths: Paths, histogram: Histogram) -> None:
    left, right = figure.subplots(1, 2, gridspec_kw={"wspace": 0.08})
    density = histogram.density.sum(axis=2) * histogram.grid.spacing[2]
    view = _as_solution(paths, grid=histogram.grid)
    image = draw_map(left, view, density, colour_scale([density]))
    image.set_interpolation("nearest")
    show_region(left, visible_region(view, [density]))
    left.set(xlabel=r"$\xi_1$", ylabel=r"$\xi_2$")
    add_colour_bar(figure, image, [left])
    _draw_angle(right, histogram)
    contours = len(left.collections) > 0
    left.set_title(f"$s = {histogram.s:g}$" + r";  contours: $p_S$" * contours)
    right.set_title(f"$s = {histogram.s:g}$")


def _draw_angle(axes: Axes, histogram: Histogram) -> None:
    """Draw the angle's histogram as steps, with ± one standard error around them."""
    width = histogram.grid.spacing[2]
    edges = np.arange(histogram.grid.shape[2] + 1) * width
    share = histogram.counts.sum(axis=(0, 1)) / histogram.n_paths
    error = np.sqrt(share * (1 - share) / histogram.n_paths)
    axes.stairs(
        (share + error) / width,
        edges,
        baseline=(share - error) / width,
        fill=True,
        color=COLOURS["blue"],
        alpha=0.25,
        linewidth=0,
        label="± one standard error",
    )
    axes.stairs(share / width, edges, color=COLOURS["blue"], baseline=None)
    axes.axhline(
        1 / (2 * math.pi), color=COLOURS["black"], linewidth=0.8, label=r"$1/(2\pi)$"
    )
    axes.set_xlim(0, 2 * math.pi)
    axes.set_xticks(
        np.arange(5) * math.pi / 2,
        ["0", r"$\pi/2$", r"$\pi$", r"$3\pi/2$", r"$2\pi$"],
    )
    axes.set_ylim(0, 1.3 * float((share + error).max()) / width)
    axes.set(xlabel=r"angle $\alpha$", ylabel=r"$\int p\;\mathrm{d}\xi$")
    axes.legend(loc="upper right", ncols=2, borderaxespad=0.2)


def _draw_moments(panels: list[Axes], paths: Paths) -> None:
    moments = paths.moments()
    view = _as_solution(
        paths,
        series={"s": moments.s, **moments.values},
        errors=dict(moments.standard_errors),
    )
    for axes, panel in zip(panels, PANELS, strict=True):
        draw_moments(axes, view, panel)
        if len(moments.s) <= _FEW:
            _mark(axes, moments, panel)


def _mark(axes: Axes, moments: Moments, panel: str) -> None:
    """Draw points with bars, because one alone has neither line nor band."""
    for curve in PANELS[panel]:
        values, errors = moments[curve.series]
        colour = COLOURS[curve.colour]
        axes.errorbar(moments.s, values, errors, fmt=".", color=colour, markersize=4)
    if len(moments.s) == 1:
        axes.set_xlim(moments.s[0] - 0.5, moments.s[0] + 0.5)


def _as_solution(paths: Paths, **parts: object) -> Solution:
    """Return what the drawing functions read of a solution, taken from the paths."""
    return cast(Solution, SimpleNamespace(model=paths.model, **parts))


def _title(paths: Paths) -> str:
    return rf"{parameters(_as_solution(paths))};  {paths.n_paths} paths"
