"""The limit of little noise: distances of laws, and eigenvalues over A²."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from fpsolve.plotting.logarithmic import noise_ticks
from fpsolve.plotting.selection import check_dataset, check_datasets
from fpsolve.plotting.style import COLOURS, COLUMN, PAGE, drawing

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["plot_small_noise", "plot_small_noise_spectrum"]

_COLOURS = ("blue", "vermilion", "green", "purple")
_MARKERS = "osD^"


def plot_small_noise(datasets: xr.Dataset | Iterable[xr.Dataset]) -> Figure:
    """Distance between the laws of G by full and averaged equation, against A.

    One panel for each potential, log-log. Markers: the full equation on a grid, one
    colour for each belt; shaded: below the error of the cells; crosses: paths; dotted:
    the distance that chance gives as many paths. Dashed: proportional to A².

    Parameters
    ----------
    datasets : xarray.Dataset or iterable of them
        From `fpsolve.studies.limits.small_noise.small_noise_limit`.
    """
    listed = check_datasets(datasets)
    with drawing(COLUMN if len(listed) == 1 else PAGE, 3.1) as figure:
        panels = figure.subplots(1, len(listed), sharey=True, squeeze=False)[0]
        # Panels share their limits.
        distances = np.concatenate([np.ravel(one["distance"]) for one in listed])
        limits = 0.5 * np.nanmin(distances), 2.0 * np.nanmax(distances)
        for axes, dataset in zip(panels, listed, strict=True):
            _draw_distances(axes, dataset, limits)
            axes.set_title(f"$B$ = {dataset.attrs['formula']}")
        panels[0].set_ylabel(r"distance of the laws of $G$")
        panels[0].legend(loc="upper left", fontsize=7)
    return figure


def _draw_distances(
    axes: Axes, dataset: xr.Dataset, limits: tuple[float, float]
) -> None:
    for place, w in enumerate(dataset["belt_speed_scale"].to_numpy()):
        one, colour = dataset.isel(belt_speed_scale=place), COLOURS[_COLOURS[place]]
        belt = "belt at rest" if w == 0 else rf"$v = {w:g}\,A^2$"
        axes.plot(one["noise"], one["distance"], _MARKERS[place] + "-", color=colour,
                  markersize=4, label=belt)  # fmt: skip
        axes.plot(one["noise"], one["paths_distance"], "x", color=colour, markersize=4)
    still = dataset.isel(belt_speed_scale=0)
    axes.set(xscale="log", yscale="log", xlabel=r"noise $A$")
    axes.fill_between(still["noise"], limits[0], still["distance_error"],
                      color="0.88", label="error of the cells")  # fmt: skip
    axes.plot(still["noise"], still["paths_distance_by_chance"], ":", color="0.4",
              label="paths by chance")  # fmt: skip
    _draw_slope(axes, still)
    axes.set_ylim(limits)
    noise_ticks(axes, dataset["noise"].to_numpy())


def _draw_slope(axes: Axes, one: xr.Dataset) -> None:
    """A², beside the distance at the second largest noise."""
    noise = one["noise"].to_numpy()
    place = min(1, len(noise) - 1)
    scale = 0.6 * float(one["distance"][place]) / noise[place] ** 2
    axes.plot(noise, scale * noise**2, "--", color="0.5", linewidth=0.9,
              label=r"$\propto A^2$")  # fmt: skip


def plot_small_noise_spectrum(dataset: xr.Dataset) -> Figure:
    """Slowest real rates of the sectors M = 0 over A², and those of |G| and signed G.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `small_noise_spectrum`.
    """
    check_dataset("dataset", dataset)
    with drawing(COLUMN, 2.6) as figure:
        axes = figure.subplots()
        for place, family in enumerate(dataset["family"].to_numpy()):
            one, colour = dataset.isel(family=place), COLOURS[_COLOURS[place]]
            axes.plot(one["noise"], one["rate"], _MARKERS[place], color=colour,
                      markersize=4, label=f"$M = 0$ {family}")  # fmt: skip
            limit = float(one["limit"])
            axes.axhline(limit, color=colour, linewidth=0.8, linestyle="--")
            axes.annotate(
                f"energy process, {family}: {limit:.6g}", (0.02, limit), (0, 3),
                xycoords=("axes fraction", "data"), textcoords="offset points",
                fontsize=7, color=colour,
            )  # fmt: skip
        highest = 1.3 * float(dataset["limit"].max())
        axes.set(ylim=(0.0, highest), xlabel=r"noise $A$", ylabel=r"rate$\,/A^2$")
        noise_ticks(axes, dataset["noise"].to_numpy())
        axes.legend(loc="center right")
    return figure
