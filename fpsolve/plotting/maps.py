"""Maps of a density over the ξ plane: colours, contours, and the window shown."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.model.laydown import LayDownModel
from fpsolve.plotting.style import DENSITY_MAP, show_frame

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Normalize
    from matplotlib.figure import FigureBase

    from fpsolve.grids.plane import PlaneGrid
    from fpsolve.grids.smooth import AnyGrid
    from fpsolve.model.fibre import FibreModel

__all__ = [
    "N_MAPS",
    "SHARES",
    "add_colour_bar",
    "colour_scale",
    "draw_density",
    "draw_map",
    "draw_plane",
    "draw_row",
    "enclosing_levels",
    "show_region",
    "visible_region",
]


# Maps in a row, at most.
N_MAPS = 4
# Shares of the equilibrium's mass that its contours enclose.
SHARES = (0.5, 0.95)
# Peaks that differ by more than this would leave the flattest map dark on a linear
# scale; the scale is that of the square root then.
_LARGEST_RATIO = 2.5
# Share of the mass of a map that may lie outside the window shown.
_MASS_OUTSIDE = 1e-3


def draw_map(
    axes: Axes,
    grid: AnyGrid | PlaneGrid,
    values: Array,
    scale: Normalize,
    stationary: Array | None,
) -> Any:
    """Draw a density over the plane and the contours of another; return the image."""
    width1, width2 = grid.half_widths
    image = axes.imshow(
        np.maximum(values, 0.0).T, origin="lower", cmap=DENSITY_MAP, norm=scale,
        extent=(-width1, width1, -width2, width2), interpolation="bilinear",
    )  # fmt: skip
    if stationary is not None:
        axes.contour(
            grid.xi1, grid.xi2, stationary.T, levels=enclosing_levels(stationary),
            colors="white", linewidths=0.8, linestyles=("--", "-"),
        )  # fmt: skip
    axes.set_aspect("equal")
    return image


def draw_density(
    grid: AnyGrid,
    model: FibreModel | None,
    axes: Axes,
    values: Array,
    scale: Normalize,
) -> Any:
    """Draw one ξ marginal and the contours of p_S; return the image."""
    stationary = None
    # Of a smooth model p_S is not the equilibrium.
    if isinstance(model, LayDownModel) and model.potential.normalisable:
        stationary = np.broadcast_to(model.equilibrium(*grid.plane()), values.shape)
    show_frame(axes)
    return draw_map(axes, grid, values, scale, stationary)


def draw_plane(
    axes: Axes, grid: AnyGrid, model: FibreModel | None, maps: list[Array]
) -> Any:
    """Draw the first of some ξ marginals, at the scale of all; return the image."""
    image = draw_density(grid, model, axes, maps[0], colour_scale(maps))
    show_region(axes, visible_region(grid, maps))
    add_colour_bar(axes.figure, image, [axes])
    axes.set(xlabel=r"$\xi_1$", ylabel=r"$\xi_2$")
    return image


def draw_row(
    figure: FigureBase,
    grid: AnyGrid | PlaneGrid,
    maps: Mapping[float, Array],
    draw: Callable[[Axes, Array, Normalize], Any],
) -> Any:
    """Draw at most four maps by their s beside each other; return the colour bar."""
    panels = figure.subplots(1, N_MAPS, sharey=True)
    for axes in panels[len(maps) :]:
        axes.set_axis_off()
    values = list(maps.values())
    scale, region = colour_scale(values), visible_region(grid, values)
    for axes, (s, one) in zip(panels, maps.items(), strict=False):
        image = draw(axes, one, scale)
        axes.set(title=f"$s = {s:g}$", xlabel=r"$\xi_1$")
        show_region(axes, region)
    panels[0].set_ylabel(r"$\xi_2$")
    return add_colour_bar(figure, image, list(panels[: len(maps)]))


def colour_scale(maps: list[Array]) -> Normalize:
    """Return the scale that maps share, from 0 to the highest peak.

    Linear, or that of the square root when the peaks differ much; the ticks of the
    colour bar show which.
    """
    from matplotlib.colors import Normalize, PowerNorm

    peaks = [float(values.max()) for values in maps]
    highest = max(*peaks, np.finfo(float).tiny)
    if min(peaks) * _LARGEST_RATIO < highest:
        return PowerNorm(0.5, vmin=0.0, vmax=highest)
    return Normalize(vmin=0.0, vmax=highest)


def enclosing_levels(density: Array) -> list[float]:
    """Return ascending levels of a density whose contours enclose the given shares."""
    descending = np.sort(density, axis=None)[::-1]
    enclosed = np.cumsum(descending) / descending.sum()
    places = [int(np.searchsorted(enclosed, share)) for share in SHARES]
    return [float(descending[place]) for place in reversed(places)]


def visible_region(grid: AnyGrid | PlaneGrid, maps: list[Array]) -> tuple[float, float]:
    """Return half widths of a window with all but 0.1 % of the mass of every map."""
    widths = []
    for axis, cells in enumerate((grid.xi1, grid.xi2)):
        distance = np.abs(cells)
        order = np.argsort(-distance)
        outside = [
            np.cumsum(np.abs(values).sum(axis=1 - axis)[order]) / np.abs(values).sum()
            for values in maps
        ]
        first = min(int(np.argmax(share > _MASS_OUTSIDE)) for share in outside)
        widths.append(float(distance[order[first]]) + grid.spacing[axis] / 2)
    return widths[0], widths[1]


def show_region(axes: Axes, region: tuple[float, float]) -> None:
    """Limit a map, and those that share its axes, to a window around the origin."""
    axes.set_xlim(-region[0], region[0])
    axes.set_ylim(-region[1], region[1])


def add_colour_bar(figure: FigureBase, image: Any, panels: list[Axes]) -> Any:
    """Add the colour bar that several maps share, and return it."""
    bar = figure.colorbar(image, ax=panels, fraction=0.05, aspect=25, pad=0.02)
    bar.set_label(r"$\int p\;\mathrm{d}\alpha$")
    bar.outline.set_linewidth(0.6)
    return bar
