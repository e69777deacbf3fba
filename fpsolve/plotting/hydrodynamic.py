"""A solution of the hydrodynamic limit: plane densities, entropy and moments."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve.plotting.maps import (
    add_colour_bar,
    colour_scale,
    enclosing_levels,
    show_region,
    visible_region,
)
from fpsolve.plotting.moments import draw_moments
from fpsolve.plotting.selection import check_hydrodynamic_solution, select_s
from fpsolve.plotting.style import (
    COLOURS,
    DENSITY_MAP,
    PAGE,
    new_figure,
    paper_style,
    parameters_of,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure, SubFigure

    from fpsolve.reduced.hydrodynamic.solution import HydrodynamicSolution

__all__ = ["plot_hydrodynamic"]

_N_MAPS = 4
# Powers of ten of the entropy that are shown; what lies lower is rounding.
_DECADES = 14


def plot_hydrodynamic(solution: HydrodynamicSolution) -> Figure:
    """Densities 𝒫(ξ, s) at saved s, the decay of H(𝒫|𝒫_S), means and spread.

    White: contours that enclose 50 and 95 % of 𝒫_S, if the model is known.

    Parameters
    ----------
    solution : HydrodynamicSolution

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ValueError
        If no density was saved.
    """
    check_hydrodynamic_solution(solution)
    chosen = select_s(solution, None, _N_MAPS)
    with paper_style():
        figure = new_figure(PAGE, 4.6)
        parts: Any = figure.subfigures(2, 1, height_ratios=(1, 1.15))
        _draw_maps(parts[0], solution, chosen)
        panels = parts[1].subplots(1, 3)
        _draw_entropy(panels[0], solution)
        draw_moments(panels[1], solution, "position")
        draw_moments(panels[2], solution, "spread")
        limit = solution.limit
        figure.suptitle(parameters_of(None if limit is None else limit.model))
    return figure


def _draw_maps(
    figure: SubFigure, solution: HydrodynamicSolution, chosen: list[float]
) -> None:
    maps = [solution.density(s) for s in chosen]
    panels = figure.subplots(1, _N_MAPS, sharey=True)
    for axes in panels[len(maps) :]:
        axes.set_axis_off()
    scale, region = colour_scale(maps), visible_region(solution, maps)
    for axes, s, values in zip(panels, chosen, maps, strict=False):
        image = _draw_map(axes, solution, values, scale)
        axes.set_title(f"$s = {s:g}$")
        axes.set_xlabel(r"$\xi_1$")
        show_region(axes, region)
    panels[0].set_ylabel(r"$\xi_2$")
    bar = add_colour_bar(figure, image, list(panels[: len(maps)]))
    bar.set_label(r"$\mathcal{P}$")


def _draw_map(
    axes: Axes, solution: HydrodynamicSolution, values: np.ndarray, scale: Normalize
) -> Any:
    grid, limit = solution.grid, solution.limit
    width1, width2 = grid.half_widths
    image = axes.imshow(
        np.maximum(values, 0.0).T, origin="lower", cmap=DENSITY_MAP, norm=scale,
        extent=(-width1, width1, -width2, width2), interpolation="bilinear",
    )  # fmt: skip
    if limit is not None:
        stationary = limit.equilibrium(*grid.mesh())
        axes.contour(
            grid.xi1, grid.xi2, stationary.T, levels=enclosing_levels(stationary),
            colors="white", linewidths=0.8, linestyles=("--", "-"),
        )  # fmt: skip
    axes.set_aspect("equal")
    return image


def _draw_entropy(axes: Axes, solution: HydrodynamicSolution) -> None:
    s, entropy = solution.series["s"], solution.series["relative_entropy"]
    lowest = float(np.max(entropy, initial=0.0)) * 10.0**-_DECADES
    shown = entropy > max(lowest, np.finfo(float).tiny)
    axes.plot(s[shown], entropy[shown], color=COLOURS["blue"])
    if shown.any():
        axes.set_yscale("log")
    axes.set_xlabel("arclength $s$")
    axes.set_ylabel(r"relative entropy $H(\mathcal{P}\,|\,\mathcal{P}_S)$")
