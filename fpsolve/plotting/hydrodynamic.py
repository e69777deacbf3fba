"""A solution of the hydrodynamic limit: plane densities, entropy and moments."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.checks import check_kind
from fpsolve.plotting.maps import N_MAPS, draw_map, draw_row
from fpsolve.plotting.moments import draw_moments
from fpsolve.plotting.selection import select_s
from fpsolve.plotting.style import COLOURS, PAGE, drawing, parameters
from fpsolve.reduced.hydrodynamic.solution import HydrodynamicSolution

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["plot_hydrodynamic"]

# Powers of ten of the entropy that are shown; what lies lower is rounding.
_DECADES = 14


def plot_hydrodynamic(solution: HydrodynamicSolution) -> Figure:
    """Densities 𝒫(ξ, s) at saved s, the decay of H(𝒫|𝒫_S), means and spread.

    White: contours that enclose 50 and 95 % of 𝒫_S, if the model is known.

    Parameters
    ----------
    solution : HydrodynamicSolution

    Raises
    ------
    ValueError
        If no density was saved.
    """
    check_kind(
        "solution", solution, HydrodynamicSolution, "see HydrodynamicLimit.solve"
    )
    grid, limit = solution.grid, solution.limit
    stationary = None if limit is None else limit.equilibrium(*grid.mesh())
    maps = {s: solution.density(s) for s in select_s(solution, None, N_MAPS)}
    with drawing(PAGE, 4.6, parameters(limit)) as figure:
        parts: Any = figure.subfigures(2, 1, height_ratios=(1, 1.15))
        bar = draw_row(
            parts[0], grid, maps,
            lambda axes, values, scale: draw_map(axes, grid, values, scale, stationary),
        )  # fmt: skip
        bar.set_label(r"$\mathcal{P}$")
        panels = parts[1].subplots(1, 3)
        _draw_entropy(panels[0], solution)
        draw_moments(panels[1], solution, "position")
        draw_moments(panels[2], solution, "spread")
    return figure


def _draw_entropy(axes: Axes, solution: HydrodynamicSolution) -> None:
    s, entropy = solution.series["s"], solution.series["relative_entropy"]
    lowest = float(np.max(entropy, initial=0.0)) * 10.0**-_DECADES
    shown = entropy > max(lowest, np.finfo(float).tiny)
    axes.plot(s[shown], entropy[shown], color=COLOURS["blue"])
    if shown.any():
        axes.set_yscale("log")
    axes.set(
        xlabel="arclength $s$",
        ylabel=r"relative entropy $H(\mathcal{P}\,|\,\mathcal{P}_S)$",
    )
