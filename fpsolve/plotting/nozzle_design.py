"""The pattern of moving nozzles against their frequency and radii."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fpsolve._support.checks import check_kind
from fpsolve.plotting.style import (
    COLOURS,
    COLUMN,
    DENSITY_MAP,
    LINES,
    drawing,
    parameters,
)
from fpsolve.studies.nozzles.result import NozzleDesign

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["plot_nozzle_design"]

_SYMBOLS = {
    "angular_speed": r"$\omega$", "radius": "$r$", "amplitude": "$r_2$",
    "radius1": "$r_1$", "radius2": "$r_2$",
}  # fmt: skip


def plot_nozzle_design(design: NozzleDesign) -> Figure:
    """CV of the mean pattern over the free numbers: all that was computed.

    Of one number a curve for every zone with the errors as bars, of two the root of the
    mean CV² as the colour of points. The optimum is a star; shaded, or framed, is where
    it may be.

    Parameters
    ----------
    design : NozzleDesign
    """
    check_kind("design", design, NozzleDesign, "it is what `design_nozzles` returns")
    told = f"d = {design.spacing:g}"
    if design.model is not None:
        told = f"{parameters(design)}, {told}"
    with drawing(COLUMN, 2.8, told) as figure:
        axes = figure.subplots()
        (_curves if len(design.names) == 1 else _map)(axes, design)
    return figure


def _curves(axes: Axes, design: NozzleDesign) -> None:
    order = np.argsort(design.points[:, 0])
    for n, zone in enumerate(design.zones):
        colour = LINES[n % len(LINES)]
        axes.errorbar(
            design.points[order, 0], 100 * design.points_cv[order, n],
            100 * design.points_errors[order, n], color=colour, marker=".",
            markersize=3, elinewidth=0.6, label=f"zones of {zone:g}",
        )  # fmt: skip
        axes.plot(design.values[0], 100 * design.pattern_cv[n], "*", color=colour,
                  markersize=9)  # fmt: skip
    axes.axvspan(*design.ranges[:, 0], color="0.9", zorder=0)
    axes.set(xscale="log", ylim=(0, None), xlabel=_SYMBOLS[design.names[0]],
             ylabel="CV of the pattern in %")  # fmt: skip
    axes.legend(loc="best")


def _map(axes: Axes, design: NozzleDesign) -> None:
    shown = axes.scatter(
        design.points[:, 0],
        design.points[:, 1],
        c=100 * np.sqrt(design.squares),
        cmap=DENSITY_MAP,
        s=18,
    )
    axes.plot(*design.values, "*", color=COLOURS["vermilion"], markersize=10)
    (left, low), (right, high) = design.ranges
    axes.plot([left, right, right, left, left], [low, low, high, high, low],
              color=COLOURS["vermilion"], linewidth=0.8)  # fmt: skip
    first, second = (_SYMBOLS[name] for name in design.names)
    axes.set(xscale="log", yscale="log", xlabel=first, ylabel=second)
    axes.figure.colorbar(shown, ax=axes, label="CV of the pattern in %")
