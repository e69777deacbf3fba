"""Moments of the density as functions of the arclength."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fpsolve.density.solution import Solution
from fpsolve.plotting.selection import check_solution
from fpsolve.plotting.style import COLOURS, PAGE, drawing, legend_above, parameters

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["draw_band", "draw_moments", "plot_moments", "show_lengths"]

# Share of the height of a panel that a line of its legend takes.
_SHARE_PER_ENTRY = 0.11
_SMALLEST_RANGE = 0.1


class _Curve(NamedTuple):
    series: str
    label: str
    colour: str
    style: str


PANELS = {
    "position": (
        _Curve("mean_xi1", r"$\mathrm{E}\,\xi_1$", "blue", "-"),
        _Curve("mean_xi2", r"$\mathrm{E}\,\xi_2$", "orange", "--"),
    ),
    "spread": (
        _Curve("variance_xi1", r"$\mathrm{Var}\,\xi_1$", "blue", "-"),
        _Curve("variance_xi2", r"$\mathrm{Var}\,\xi_2$", "orange", "--"),
        _Curve("covariance", r"$\mathrm{Cov}(\xi_1, \xi_2)$", "green", "-."),
    ),
    "direction": (
        _Curve("mean_cos_alpha", r"$\mathrm{E}\,\cos\alpha$", "blue", "-"),
        _Curve("mean_sin_alpha", r"$\mathrm{E}\,\sin\alpha$", "orange", "--"),
    ),
}


def plot_moments(solution: Solution) -> Figure:
    """Means and covariances of ξ and the mean direction E τ(α) against s.

    With error estimates a band of ± one estimate surrounds each curve. On a belt the
    dotted line is -v, the limit of E cos α.

    Parameters
    ----------
    solution : Solution
    """
    check_solution(solution)
    with drawing(PAGE, 2.6, parameters(solution)) as figure:
        panels = figure.subplots(1, len(PANELS))
        for axes, name in zip(panels, PANELS, strict=True):
            draw_moments(axes, solution, name)
    return figure


def draw_moments(axes: Axes, shown: Any, panel: str) -> None:
    """Draw the moments of "position", "spread" or "direction" into one panel.

    Of what is shown `series` is read, and `errors` if there are any.
    """
    s, errors = shown.series["s"], shown.errors or {}
    for curve in PANELS[panel]:
        values, colour = shown.series[curve.series], COLOURS[curve.colour]
        axes.plot(s, values, color=colour, ls=curve.style, label=curve.label)
        if curve.series in errors:
            draw_band(axes, s, values, errors[curve.series], colour)
    if panel == "direction" and isinstance(shown, Solution):
        _draw_limit(axes, shown)
    show_lengths(axes, s)
    axes.set_ylabel(panel)
    _widen(axes)
    legend_above(axes, _SHARE_PER_ENTRY * len(axes.get_legend_handles_labels()[0]))


def draw_band(
    axes: Axes,
    x: NDArray[np.float64],
    values: NDArray[np.float64],
    error: NDArray[np.float64],
    colour: str,
) -> None:
    """Shade ± one error around a curve."""
    axes.fill_between(
        x, values - error, values + error, color=colour, alpha=0.25, linewidth=0
    )


def show_lengths(axes: Axes, s: NDArray[np.float64]) -> None:
    """Let an axis reach from the first arclength to the last."""
    end = s[-1] if s[-1] > s[0] else s[0] + 1
    axes.set(xlim=(s[0], end), xlabel=r"arclength $s$")


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
