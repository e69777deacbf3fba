"""Moments of the density as functions of the arclength."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from fpsolve.density.solution import Solution
from fpsolve.plotting.selection import check_solution
from fpsolve.plotting.style import (
    COLOURS,
    PAGE,
    legend_above,
    new_figure,
    paper_style,
    parameters,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fpsolve.reduced.hydrodynamic.solution import HydrodynamicSolution

__all__ = ["draw_moments", "plot_moments"]


# Share of the height of a panel that a line of its legend takes.
_SHARE_PER_ENTRY = 0.11
_SMALLEST_RANGE = 0.1


class _Curve(NamedTuple):
    series: str
    label: str
    colour: str
    style: str


_POSITION = (
    _Curve("mean_xi1", r"$\mathrm{E}\,\xi_1$", "blue", "-"),
    _Curve("mean_xi2", r"$\mathrm{E}\,\xi_2$", "orange", "--"),
)
_SPREAD = (
    _Curve("variance_xi1", r"$\mathrm{Var}\,\xi_1$", "blue", "-"),
    _Curve("variance_xi2", r"$\mathrm{Var}\,\xi_2$", "orange", "--"),
    _Curve("covariance", r"$\mathrm{Cov}(\xi_1, \xi_2)$", "green", "-."),
)
_DIRECTION = (
    _Curve("mean_cos_alpha", r"$\mathrm{E}\,\cos\alpha$", "blue", "-"),
    _Curve("mean_sin_alpha", r"$\mathrm{E}\,\sin\alpha$", "orange", "--"),
)
PANELS = {"position": _POSITION, "spread": _SPREAD, "direction": _DIRECTION}


def plot_moments(solution: Solution) -> Figure:
    """Means and covariances of ξ and the mean direction E τ(α) against s.

    With error estimates a band of ± one estimate surrounds each curve. On a belt the
    dotted line is -v, the limit of E cos α.

    Parameters
    ----------
    solution : Solution

    Returns
    -------
    matplotlib.figure.Figure
    """
    check_solution(solution)
    with paper_style():
        figure = new_figure(PAGE, 2.6)
        panels = figure.subplots(1, len(PANELS))
        for axes, name in zip(panels, PANELS, strict=True):
            draw_moments(axes, solution, name)
        figure.suptitle(parameters(solution))
    return figure


def draw_moments(
    axes: Axes, solution: Solution | HydrodynamicSolution, panel: str
) -> None:
    """Draw the moments of "position", "spread" or "direction" into one panel."""
    s = solution.series["s"]
    for curve in PANELS[panel]:
        values = solution.series[curve.series]
        axes.plot(
            s, values, color=COLOURS[curve.colour], ls=curve.style, label=curve.label
        )
        error = (solution.errors or {}).get(curve.series)
        if error is not None:
            axes.fill_between(
                s,
                values - error,
                values + error,
                color=COLOURS[curve.colour],
                alpha=0.25,
                linewidth=0,
            )
    if panel == "direction" and isinstance(solution, Solution):
        _draw_limit(axes, solution)
    axes.set_xlim(s[0], s[-1] if s[-1] > s[0] else s[0] + 1)
    axes.set_xlabel(r"arclength $s$")
    axes.set_ylabel(panel)
    _widen(axes)
    legend_above(axes, _SHARE_PER_ENTRY * len(axes.get_legend_handles_labels()[0]))


def _widen(axes: Axes) -> None:
    """Keep rounding errors of moments that vanish from filling the panel."""
    bottom, top = axes.get_ylim()
    missing = _SMALLEST_RANGE - (top - bottom)
    if missing > 0:
        axes.set_ylim(bottom - missing / 2, top + missing / 2)


def _draw_limit(axes: Axes, solution: Solution) -> None:
    """Draw -v, which E cos α tends to because the mean of ξ comes to rest."""
    model = solution.model
    if model is None or not model.curve.autonomous or model.curve.fixed:
        return
    speed = model.belt_speed
    axes.axhline(-speed, color=COLOURS["black"], ls=":", label=f"$-v = {-speed:g}$")
