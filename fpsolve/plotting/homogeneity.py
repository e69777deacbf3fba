"""The variation of laid webs beside what was predicted."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fpsolve.plotting.logarithmic import legend_with_room, plain_numbers
from fpsolve.plotting.selection import check_dataset
from fpsolve.plotting.style import LINES, MARKERS, PAGE, drawing

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["plot_web_homogeneity"]

# Of ticks in a decade, and the ratio above which only powers of ten are told.
_DIGITS, _RATIO = (1, 2, 5), 300.0


def plot_web_homogeneity(dataset: xr.Dataset) -> Figure:
    """CV of square zones by their side: lines predicted, markers laid.

    One panel for every noise and belt speed, a colour for every distance of the
    spinning positions; bars are standard errors.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `web_homogeneity`.
    """
    check_dataset("dataset", dataset)
    if "simulated" not in dataset or "spacing" not in dataset.coords:
        raise ValueError(
            '`dataset` must come from `web_homogeneity`, got one without "simulated" '
            'over "spacing".'
        )
    noises, speeds = dataset.sizes["noise"], dataset.sizes["belt_speed"]
    title = f"$B$ = {dataset.attrs['formula']},  {dataset.attrs['positions']} positions"
    with drawing(PAGE, 0.6 + 2.5 * noises, title) as figure:
        grid = figure.subplots(noises, speeds, squeeze=False, sharex=True)
        for (row, column), axes in np.ndenumerate(grid):
            _draw(axes, dataset.isel(noise=row, belt_speed=column))
        for axes in grid[:, 0]:
            axes.set_ylabel("CV in %")
        for axes in grid[-1]:
            axes.set_xlabel("side of the zone $x$")
        legend_with_room(grid[0, 0])
    return figure


def _draw(axes: Axes, dataset: xr.Dataset) -> None:
    zones = dataset["zone"].to_numpy()
    axes.set(xscale="log", yscale="log")
    for n, spacing in enumerate(dataset["spacing"].to_numpy()):
        one = 100 * dataset[["predicted", "simulated", "standard_error"]].sel(
            spacing=spacing
        )
        if not one["simulated"].notnull().any():
            continue
        colour = LINES[n % len(LINES)]
        axes.plot(zones, one["predicted"], color=colour, linewidth=0.8)
        axes.errorbar(
            zones, one["simulated"], one["standard_error"], linestyle="none",
            marker=MARKERS[n % len(MARKERS)], markersize=3.5, color=colour,
            label=f"$d$ = {spacing:g}",
        )  # fmt: skip
    axes.set_title(
        f"$A$ = {float(dataset['noise']):g},  $v$ = {float(dataset['belt_speed']):g}"
    )
    for axis in (axes.xaxis, axes.yaxis):
        plain_numbers(axis, _DIGITS, _RATIO)
