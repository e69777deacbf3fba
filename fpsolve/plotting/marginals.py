"""Marginal densities over the ξ plane."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from fpsolve.density.solution import Solution
from fpsolve.plotting.maps import (
    SHARES,
    add_colour_bar,
    colour_scale,
    draw_density,
    show_region,
    visible_region,
)
from fpsolve.plotting.selection import check_solution, select_s
from fpsolve.plotting.style import COLUMN, PAGE, drawing, parameters

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["label_outer", "plot_marginals"]

_MOST_MAPS, _MAPS_PER_ROW = 8, 4


def plot_marginals(solution: Solution, at: Iterable[float] | None = None) -> Figure:
    """∫ p dα at several s, with contours of the equilibrium p_S.

    All maps share one colour scale. The contours enclose 50 % and 95 % of the mass of
    p_S = c exp(-B); on a moving belt p_S is the reference density of the entropy, not
    the stationary one.

    Parameters
    ----------
    solution : Solution
    at : iterable of float, optional
        Saved arclengths to show; by default all, at most eight of them.

    Raises
    ------
    ValueError
        If no density was saved, or none at one of the arclengths.
    """
    check_solution(solution)
    chosen = select_s(solution, at, _MOST_MAPS)
    maps = [solution.marginal("xi", s) for s in chosen]
    n_rows, n_columns = _layout(len(maps))
    region = visible_region(solution.grid, maps)
    title = _map_title(solution, one_line=n_columns > 1)
    with drawing(*_map_size(region, n_rows, n_columns), title) as figure:
        panels = figure.subplots(
            n_rows, n_columns, sharex=True, sharey=True, squeeze=False
        )
        scale = colour_scale(maps)
        for axes, s, values in zip(panels.flat, chosen, maps, strict=False):
            image = draw_density(solution.grid, solution.model, axes, values, scale)
            axes.set_title(f"$s = {s:g}$")
        show_region(panels.flat[0], region)
        label_outer(panels, len(maps))
        add_colour_bar(figure, image, panels.ravel()[: len(maps)].tolist())
    return figure


def _layout(n_maps: int) -> tuple[int, int]:
    n_columns = min(n_maps, _MAPS_PER_ROW)
    if n_maps > _MAPS_PER_ROW:
        n_columns = math.ceil(n_maps / 2)
    return math.ceil(n_maps / n_columns), n_columns


def _map_size(
    region: tuple[float, float], n_rows: int, n_columns: int
) -> tuple[float, float]:
    width = COLUMN if n_columns == 1 else PAGE
    panel = (width - 1.35) / n_columns - 0.1
    return width, n_rows * (panel * region[1] / region[0] + 0.3) + 0.65


def label_outer(panels: NDArray[Any], n_panels: int) -> None:
    """Name ξ1 and ξ2 where a panel has no neighbour; remove those that are too many."""
    n_columns = panels.shape[1]
    for axes in panels.flat[n_panels:]:
        axes.remove()
    for index, axes in enumerate(panels.flat[:n_panels]):
        if index % n_columns == 0:
            axes.set_ylabel(r"$\xi_2$")
        if index + n_columns >= n_panels:
            axes.set_xlabel(r"$\xi_1$")
            axes.tick_params(labelbottom=True)


def _map_title(solution: Solution, one_line: bool) -> str:
    model = solution.model
    title = parameters(solution)
    if model is None or not model.potential.normalisable:
        return title
    first, second = (f"{share:.0%}".replace("%", r" %") for share in SHARES)
    separator = ";  " if one_line and "\n" not in title else "\n"
    contours = f"contours: $p_S$, {second} (dashed) and {first} of its mass"
    return f"{title}{separator}{contours}"
