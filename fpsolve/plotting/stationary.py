"""A stationary density: its map over the plane, and its angle."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.checks import check_kind
from fpsolve.density.steady_state import SteadyState
from fpsolve.plotting.maps import (
    add_colour_bar,
    colour_scale,
    draw_map,
    show_region,
    visible_region,
)
from fpsolve.plotting.style import COLOURS, PAGE, new_figure, paper_style, parameters_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["plot_steady_state"]


def plot_steady_state(result: SteadyState) -> Figure:
    """∫ p dα over the ξ plane, and ∫ p dξ over α beside the uniform density.

    White: contours that enclose 50 and 95 % of c exp(-B), which is the stationary
    density on a belt at rest.

    Parameters
    ----------
    result : SteadyState

    Returns
    -------
    matplotlib.figure.Figure
    """
    check_kind("result", result, SteadyState, "it is what `steady_state` returns")
    shown: Any = result
    with paper_style():
        figure = new_figure(PAGE, 3.0)
        plane, angle = figure.subplots(1, 2, width_ratios=(1.2, 1.0))
        density = result.marginal("xi")
        image = draw_map(plane, shown, density, colour_scale([density]))
        show_region(plane, visible_region(shown, [density]))
        add_colour_bar(figure, image, [plane])
        plane.set_xlabel(r"$\xi_1$")
        plane.set_ylabel(r"$\xi_2$")
        angle.plot(result.grid.alpha, result.marginal("alpha"), color=COLOURS["blue"])
        angle.axhline(0.5 / np.pi, color="0.5", linewidth=0.8, linestyle="--")
        angle.set_xlabel(r"$\alpha$")
        angle.set_ylabel(r"$\int p\;\mathrm{d}\xi$")
        angle.set_ylim(bottom=0.0)
        figure.suptitle(parameters_of(result.model))
    return figure
