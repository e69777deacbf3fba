"""Maps of a density over the ξ plane: colours, contours, and the window shown."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fpsolve.density.solution import Solution
from fpsolve.plotting.style import DENSITY_MAP

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Normalize
    from matplotlib.figure import FigureBase

    from fpsolve.reduced.hydrodynamic.solution import HydrodynamicSolution

__all__ = [
    "SHARES",
    "add_colour_bar",
    "colour_scale",
    "draw_map",
    "enclosing_levels",
    "show_region",
    "visible_region",
]

# Shares of the equilibrium's mass that its contours enclose.
SHARES = (0.5, 0.95)
# Peaks that differ by more than this would leave the flattest map dark on a linear
# scale; the scale is that of the square root then.
_LARGEST_RATIO = 2.5
# Share of the mass of a map that may lie outside the window shown.
_MASS_OUTSIDE = 1e-3


def draw_map(
    axes: Axes, solution: Solution, values: NDArray[np.float64], scale: Normalize
) -> Any:
    """Draw one ξ marginal and the contours of p_S; return the image."""
    width1, width2 = solution.grid.half_widths
    image = axes.imshow(
        np.maximum(values, 0.0).T,
        origin="lower",
        extent=(-width1, width1, -width2, width2),
        cmap=DENSITY_MAP,
        norm=scale,
        interpolation="bilinear",
    )
    model = solution.model
    if model is not None and model.potential.normalisable:
        xi1, xi2 = solution.grid.plane()
        equilibrium = np.broadcast_to(model.equilibrium(xi1, xi2), values.shape)
        axes.contour(
            solution.grid.xi1,
            solution.grid.xi2,
            equilibrium.T,
            levels=enclosing_levels(equilibrium),
            colors="white",
            linewidths=0.8,
            linestyles=("--", "-"),
        )
    axes.set_aspect("equal")
    for side in ("top", "right"):
        axes.spines[side].set_visible(True)
    return image


def colour_scale(maps: list[NDArray[np.float64]]) -> Normalize:
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


def enclosing_levels(density: NDArray[np.float64]) -> list[float]:
    """Return ascending levels of a density whose contours enclose the given shares."""
    descending = np.sort(density, axis=None)[::-1]
    enclosed = np.cumsum(descending) / descending.sum()
    places = [int(np.searchsorted(enclosed, share)) for share in SHARES]
    return [float(descending[place]) for place in reversed(places)]


def visible_region(
    solution: Solution | HydrodynamicSolution, maps: list[NDArray[np.float64]]
) -> tuple[float, float]:
    """Return half widths of a window with all but 0.1 % of the mass of every map."""
    grid = solution.grid
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
