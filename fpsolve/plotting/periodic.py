"""A time-periodic density: maps at four phases, and its means over the period."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_kind
from fpsolve.density.periodic.result import PeriodicState
from fpsolve.plotting.maps import N_MAPS, draw_density, draw_row
from fpsolve.plotting.style import LINES, PAGE, drawing, parameters

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

__all__ = ["plot_periodic_state"]


def plot_periodic_state(result: PeriodicState) -> Figure:
    """∫ p dα over the ξ plane at four phases, and E ξ and E τ over the period.

    White: contours that enclose 50 and 95 % of c exp(-B), which is the stationary
    density on a belt at rest.

    Parameters
    ----------
    result : PeriodicState
    """
    check_kind("result", result, PeriodicState, "it is what `periodic_state` returns")
    moments, planes = result.moments(), result.marginal("xi")
    shown = [k * result.s.size // N_MAPS for k in range(N_MAPS)]
    with drawing(PAGE, 3.8, parameters(result)) as figure:
        parts: Any = figure.subfigures(2, 1, height_ratios=(1.25, 1.0))
        above, below = parts
        maps = {result.s[j]: planes[j] for j in shown}

        def draw(axes: Axes, values: Array, scale: Normalize) -> Any:
            return draw_density(result.grid, result.model, axes, values, scale)

        draw_row(above, result.grid, maps, draw)
        position, direction = below.subplots(1, 2)
        for axes, words, names in (
            (position, r"$E\,\xi_{}$", ("mean_xi1", "mean_xi2")),
            (direction, r"$E\,\tau_{}$", ("mean_cos_alpha", "mean_sin_alpha")),
        ):
            for k, (name, colour) in enumerate(zip(names, LINES, strict=False)):
                label = words.replace("{}", str(k + 1))
                axes.plot(result.s, moments[name], color=colour, label=label)
            axes.set(xlabel=r"$s$", xlim=(0.0, result.period))
            axes.legend(fontsize="small")
    return figure
