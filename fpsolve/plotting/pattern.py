"""What nozzles in phase lay down on average, seen from above."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fpsolve._support.checks import check_kind, check_positive
from fpsolve.plotting.maps import add_colour_bar
from fpsolve.plotting.style import DENSITY_MAP, PAGE, drawing, show_frame
from fpsolve.web.pattern_result import MeanPattern

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["plot_pattern"]

# Points along the belt of a map; the width of one map among several in a row and what
# stands above and below it, in inches.
POINTS, ACROSS, AROUND, FOOT = 240, 5.6, 0.35, 0.5
IN_A_ROW = 2
# Cells that are shown: enough to see that they are repeated, and as many as its points
# can tell apart.
FEWEST_CELLS, MOST_CELLS = 2, 20


def plot_pattern(
    patterns: MeanPattern | Sequence[MeanPattern],
    length: float | None = None,
    width: float | None = None,
    titles: Sequence[str] = (),
) -> Figure:
    """E m relative to its mean on a part of the belt, on one scale of colours.

    Parameters
    ----------
    patterns : MeanPattern or sequence of MeanPattern
        Drawn two by two.
    length, width : float, optional
        Of the part that is shown, along the belt and across it; by default those of a
        square that holds two cells of the first pattern, but not more than 20.
    titles : sequence of str
        One for every pattern.
    """
    several = [patterns] if isinstance(patterns, MeanPattern) else list(patterns)
    for one in several:
        check_kind("patterns", one, MeanPattern, "it is what `mean_pattern` returns")
    side = side_of(several[0].length, several[0].width)
    length = side if length is None else length
    width = side if width is None else width
    length, width = check_positive("length", length), check_positive("width", width)
    x1 = np.linspace(0.0, length, POINTS)
    x2 = np.linspace(0.0, width, max(2, round(POINTS * width / length)))
    maps = [one.relative_at(x1, x2) for one in several]
    highest = max(float(one.max()) for one in maps)
    columns = min(IN_A_ROW, len(maps))
    rows = -(-len(maps) // columns)
    height = FOOT + rows * (AROUND + ACROSS / columns * width / length)
    with drawing(PAGE, height) as figure:
        panels = figure.subplots(
            rows, columns, squeeze=False, sharex=True, sharey=True
        )  # fmt: skip
        for axes in panels.flat[len(maps) :]:
            axes.set_axis_off()
        for k, (axes, values) in enumerate(zip(panels.flat, maps, strict=False)):
            image = axes.imshow(
                values, origin="lower", extent=(0.0, length, 0.0, width), vmin=0.0,
                vmax=highest, cmap=DENSITY_MAP, interpolation="bilinear",
            )  # fmt: skip
            show_frame(axes)
            axes.set_title(titles[k] if k < len(titles) else "", fontsize="small")
        for axes in panels[-1]:
            axes.set_xlabel(r"$x_1$ along the belt")
        for axes in panels[:, 0]:
            axes.set_ylabel(r"$x_2$")
        add_colour_bar(figure, image, list(panels.flat)).set_label(r"$v\,d\;E\,m$")
    return figure


def side_of(length: float, width: float) -> float:
    """Of a square that shows how cells of this size are repeated."""
    return min(FEWEST_CELLS * max(length, width), MOST_CELLS * min(length, width))
