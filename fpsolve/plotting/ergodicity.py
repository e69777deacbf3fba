"""Convergence of averages along paths, against arclength and against noise."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import cycle
from typing import TYPE_CHECKING

import numpy as np

from fpsolve.plotting.logarithmic import legend_with_room, plain_numbers
from fpsolve.plotting.moments import draw_band
from fpsolve.plotting.selection import check_dataset, evenly
from fpsolve.plotting.style import COLOURS, LINES, MARKERS, PAGE, drawing
from fpsolve.studies.ergodicity.fit import ErgodicFit, ErrorShape, fit_ergodic_error

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["plot_ergodic_averages", "symbol"]

_MOST_NOISES = 5
# Below this many standard errors an asymptotic variance is not drawn.
_CLEAR = 3.0
# Of curves, from small to large noise.
_SHADES = ("blue", "sky", "green", "orange", "vermilion", "purple", "black")
_SYMBOLS = {
    "position": r"$\xi_1$",
    "square": r"$\|\xi\|^2$",
    "core": r"$e^{-\|\xi\|^2/2}$",
    "direction": r"$\cos\,\alpha$",
    "circulation": r"$e^{-B}\,\xi\times\tau$",
}


def plot_ergodic_averages(
    dataset: xr.Dataset,
    *,
    function: str = "square",
    noises: Iterable[float] | None = None,
    fit: ErgodicFit | None = None,
) -> Figure:
    """Error of averages against s, and its asymptotic variance against A.

    Left: ‖s⁻¹∫f − E f‖ / ‖f − E f‖ of one function for some noises, with two standard
    errors, and the slope s^{−1/2}. Right: the limit of s error², in units of
    ‖f − E f‖², for all functions in which it can be told from zero; dashed the square
    of the fitted shape c₁(c₂/A + c₃A), and a star where the measured one is least.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `ergodic_averages`.
    function : str
        The function on the left.
    noises : iterable of float, optional
        Noises on the left, of those in the dataset; by default up to five.
    fit : ErgodicFit, optional
        By default `fit_ergodic_error(dataset)`.

    Raises
    ------
    ValueError
        If the function or a noise is not in the dataset.
    """
    check_dataset("dataset", dataset)
    known = [str(name) for name in dataset["function"].to_numpy()]
    if function not in known:
        raise ValueError(
            f"`function` must be one of {', '.join(known)}, got {function!r}."
        )
    chosen = _chosen_noises(dataset, noises)
    fit = fit_ergodic_error(dataset) if fit is None else fit
    with drawing(PAGE, 3.1, _title(dataset)) as figure:
        left, right = figure.subplots(1, 2)
        _draw_errors(left, dataset, function, chosen)
        _draw_variances(right, dataset, fit)
    return figure


def _chosen_noises(dataset: xr.Dataset, noises: Iterable[float] | None) -> list[float]:
    known = np.sort(dataset["noise"].to_numpy())
    if noises is None:
        return [float(known[place]) for place in evenly(known.size, _MOST_NOISES)]
    chosen = []
    for noise in noises:
        nearest = float(known[np.argmin(np.abs(known - noise))])
        if not abs(nearest - noise) <= 1e-9 * nearest:
            names = ", ".join(f"{one:g}" for one in known)
            raise ValueError(f"`noises` must be among {names}, got {noise:g}.")
        chosen.append(nearest)
    return chosen


def _draw_errors(
    axes: Axes, dataset: xr.Dataset, function: str, noises: list[float]
) -> None:
    selected = dataset.sel(function=function)
    deviation = float(selected["deviation"])
    s = selected["s"].to_numpy()
    for noise, shade in zip(noises, cycle(_SHADES), strict=False):
        one, colour = selected.sel(noise=noise), COLOURS[shade]
        error = one["error"].to_numpy() / deviation
        band = 2 * one["error_standard_error"].to_numpy() / deviation
        draw_band(axes, s, error, band, colour)
        axes.plot(s, error, color=colour, label=f"$A = {noise:.2g}$")
    _draw_slope(axes)
    axes.set(
        xscale="log",
        yscale="log",
        xlim=(s[0], s[-1]),
        xlabel=r"arclength $s$",
        ylabel=r"$\|s^{-1}\!\int f - \mathrm{E} f\| \,/\, \|f - \mathrm{E} f\|$",
        title=f"$f =$ {symbol(function)}",
    )
    plain_numbers(axes.yaxis, (1, 2, 3, 5), 30)
    axes.legend(loc="lower left", borderaxespad=0.2)


def _draw_slope(axes: Axes) -> None:
    """A line of slope −1/2 above the curves, over the later half of the axis."""
    s = np.asarray(axes.lines[0].get_xdata())
    places = s[[-min(8, s.size), -1]]
    curves = [np.asarray(line.get_data(), dtype=float) for line in axes.lines]
    tops = [float(np.interp(places[0], *curve)) for curve in curves]
    heights = 1.35 * max(tops) * np.sqrt(places[0] / places)
    axes.plot(places, heights, color=COLOURS["black"], linewidth=0.8)
    axes.annotate(
        r"$s^{-1/2}$",
        (float(np.sqrt(places.prod())), float(np.sqrt(heights.prod()))),
        xytext=(3, 3),
        textcoords="offset points",
    )


def _draw_variances(axes: Axes, dataset: xr.Dataset, fit: ErgodicFit) -> None:
    noises = dataset["noise"].to_numpy()
    fine = np.geomspace(noises.min(), noises.max(), 200)
    looks = zip(cycle(LINES), cycle(MARKERS), strict=True)
    for name in map(str, dataset["function"].to_numpy()):
        one = dataset.sel(function=name)
        variance = one["asymptotic_variance"].to_numpy()
        error = one["asymptotic_variance_standard_error"].to_numpy()
        if not np.all(variance > _CLEAR * error):
            continue
        scale = float(one["deviation"]) ** 2
        colour, marker = next(looks)
        axes.errorbar(
            noises, variance / scale, 2 * error / scale, color=colour,
            marker=marker, markersize=3.5, linestyle="none",
            elinewidth=0.8, label=symbol(name),
        )  # fmt: skip
        axes.plot(fine, fit[name].variance(fine), "--", color=colour, linewidth=0.9)
        _mark_least(axes, fit[name], colour, variance / scale, noises)
    axes.set(
        xscale="log",
        yscale="log",
        xlabel=r"noise $A$",
        ylabel=r"$\lim\; s\,\mathrm{error}^2 \,/\, \|f - \mathrm{E} f\|^2$",
        title="asymptotic variance; dashed: $c_1^2(c_2/A + c_3A)^2$",
    )
    plain_numbers(axes.xaxis, (1, 2, 3, 5), 30)
    legend_with_room(axes, borderaxespad=0.2)


def _mark_least(
    axes: Axes, shape: ErrorShape, colour: str, variance: np.ndarray, noises: np.ndarray
) -> None:
    """A star, with its uncertainty, where the measured variance is least."""
    if shape.measured.trend != "interior":
        return
    place, error = shape.measured.noise, shape.measured.standard_error
    height = np.exp(np.interp(np.log(place), np.log(noises), np.log(variance)))
    axes.errorbar(
        [place], [height], xerr=[2 * error], color=COLOURS["black"], marker="*",
        markersize=8, markerfacecolor=colour, markeredgewidth=0.6, elinewidth=0.8,
        zorder=5,
    )  # fmt: skip


def symbol(name: str) -> str:
    """Return a function of the studies as a formula; of a user's own its name."""
    return _SYMBOLS.get(name, name)


def _title(dataset: xr.Dataset) -> str:
    formula, n_paths = dataset.attrs["formula"], dataset.attrs["n_paths"]
    return f"$B$ = {formula};  {n_paths} paths from equilibrium for each noise"
