"""What many paths say together: histograms and moments with their standard errors."""

from __future__ import annotations

from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.plotting.angle import draw_uniform, show_turn
from fpsolve.plotting.maps import draw_plane
from fpsolve.plotting.moments import PANELS, draw_moments
from fpsolve.plotting.selection import check_paths
from fpsolve.plotting.style import COLOURS, PAGE, drawing, parameters

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

    Raises
    ------
    ValueError
        If nothing was saved at `s`.
    """
    check_paths(paths)
    histogram = _histogram(paths, s)
    height = 2.6 if histogram is None else 2.8 if len(paths.s) == 1 else 4.9
    title = rf"{parameters(paths)};  {paths.n_paths} paths"
    with drawing(PAGE, height, title) as figure:
        if histogram is None:
            _draw_moments(figure.subplots(1, 3), paths)
        elif len(paths.s) == 1:
            _draw_histograms(figure, paths, histogram)
        else:
            parts: Any = figure.subfigures(2, 1, height_ratios=(1.15, 1))
            _draw_histograms(parts[0], paths, histogram)
            _draw_moments(parts[1].subplots(1, 3), paths)
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
    image = draw_plane(left, histogram.grid, paths.model, [density])
    image.set_interpolation("nearest")
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
        (share + error) / width, edges, baseline=(share - error) / width, fill=True,
        color=COLOURS["blue"], alpha=0.25, linewidth=0, label="± one standard error",
    )  # fmt: skip
    axes.stairs(share / width, edges, color=COLOURS["blue"], baseline=None)
    draw_uniform(axes)
    show_turn(axes)
    axes.set_ylim(0, 1.3 * float((share + error).max()) / width)
    axes.legend(loc="upper right", ncols=2, borderaxespad=0.2)


def _draw_moments(panels: list[Axes], paths: Paths) -> None:
    moments = paths.moments()
    view = SimpleNamespace(
        series={"s": moments.s, **moments.values}, errors=moments.standard_errors
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
