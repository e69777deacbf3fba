"""A stationary density: its map over the plane, and its angle."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fpsolve._support.checks import check_kind
from fpsolve.density.steady_state import SteadyState
from fpsolve.plotting.maps import draw_plane
from fpsolve.plotting.style import COLOURS, PAGE, drawing, parameters

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
    """
    check_kind("result", result, SteadyState, "it is what `steady_state` returns")
    with drawing(PAGE, 3.0, parameters(result)) as figure:
        plane, angle = figure.subplots(1, 2, width_ratios=(1.2, 1.0))
        draw_plane(plane, result.grid, result.model, [result.marginal("xi")])
        angle.plot(result.grid.alpha, result.marginal("alpha"), color=COLOURS["blue"])
        angle.axhline(0.5 / np.pi, color="0.5", linewidth=0.8, linestyle="--")
        angle.set(xlabel=r"$\alpha$", ylabel=r"$\int p\;\mathrm{d}\xi$")
        angle.set_ylim(bottom=0.0)
    return figure
