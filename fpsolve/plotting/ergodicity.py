"""Convergence of averages along paths, against arclength and against noise."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from fpsolve.plotting.selection import check_dataset
from fpsolve.plotting.style import COLOURS, PAGE, new_figure, paper_style
from fpsolve.studies.ergodicity.fit import ErgodicFit, ErrorShape, fit_ergodic_error

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

__all__ = ["plot_ergodic_averages"]

_MOST_NOISES = 5
# Below this many standard errors an asymptotic variance is not drawn.
_CLEAR = 3.0
_SYMBOLS = {
    "position": r"$\xi_1$",
    "square": r"$\|\xi\|^2$",
    "core": r"$e^{-\|\xi\|^2/2}$",
    "direction": r"$\cos\,\alpha$",
    "circulation": r"$e^{-B}\,\xi\times\tau$",
}
_MARKERS = "osD^vP"


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

    Returns
    -------
    matplotlib.figure.Figure

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
    with paper_style():
        figure = new_figure(PAGE, 3.1)
        left, right = figure.subplots(1, 2)
        _draw_errors(left, dataset, function, chosen)
        _draw_variances(right, dataset, fit)
        figure.suptitle(_title(dataset))
    return figure


def _chosen_noises(dataset: xr.Dataset, noises: Iterable[float] | None) -> list[float]:
    known = np.sort(dataset["noise"].to_numpy())
    if noises is None:
        count = min(known.size, _MOST_NOISES)
        places = np.linspace(0, known.size - 1, count).round().astype(int)
        return [float(noise) for noise in known[places]]
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
    for noise, colour in zip(noises, _shades(len(noises)), strict=True):
        one = selected.sel(noise=noise)
        error = one["error"].to_numpy() / deviation
        band = 2 * one["error_standard_error"].to_numpy() / deviation
        axes.fill_between(
            s, error - band, error + band, color=colour, alpha=0.25, linewidth=0
        )
        axes.plot(s, error, color=colour, label=f"$A = {noise:.2g}$")
    _draw_slope(axes)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(s[0], s[-1])
    _plain_numbers(axes.yaxis)
    axes.set_xlabel(r"arclength $s$")
    axes.set_ylabel(r"$\|s^{-1}\!\int f - \mathrm{E} f\| \,/\, \|f - \mathrm{E} f\|$")
    axes.set_title(f"$f =$ {_symbol(function)}")
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
    names = [str(name) for name in dataset["function"].to_numpy()]
    colours = [colour for name, colour in COLOURS.items() if name != "black"]
    drawn = 0
    for name in names:
        one = dataset.sel(function=name)
        variance = one["asymptotic_variance"].to_numpy()
        error = one["asymptotic_variance_standard_error"].to_numpy()
        if not np.all(variance > _CLEAR * error):
            continue
        scale = float(one["deviation"]) ** 2
        colour = colours[drawn % len(colours)]
        axes.errorbar(
            noises, variance / scale, 2 * error / scale, color=colour,
            marker=_MARKERS[drawn % len(_MARKERS)], markersize=3.5, linestyle="none",
            elinewidth=0.8, label=_symbol(name),
        )  # fmt: skip
        axes.plot(fine, fit[name].variance(fine), "--", color=colour, linewidth=0.9)
        _mark_least(axes, fit[name], colour, variance / scale, noises)
        drawn += 1
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel(r"noise $A$")
    axes.set_ylabel(r"$\lim\; s\,\mathrm{error}^2 \,/\, \|f - \mathrm{E} f\|^2$")
    axes.set_title("asymptotic variance; dashed: $c_1^2(c_2/A + c_3A)^2$")
    _plain_numbers(axes.xaxis)
    if drawn:
        axes.legend(loc="upper center", ncols=2, borderaxespad=0.2)
        bottom, top = axes.get_ylim()
        axes.set_ylim(bottom, top * (top / bottom) ** 0.3)


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


def _plain_numbers(axis: Axis) -> None:
    """Label 0.2, 0.5, 1, … along a range of about a decade; not 5 x 10⁻¹."""
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

    low, high = axis.get_view_interval()
    digits = [1, 2, 3, 5] if high < 30 * low else [1]
    candidates = np.outer(10.0 ** np.arange(-6, 7), digits).ravel()
    axis.set_major_locator(FixedLocator(candidates[candidates >= low].tolist()))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_locator(NullLocator())


def _shades(count: int) -> list[str]:
    """Colours from small to large noise."""
    order = ("blue", "sky", "green", "orange", "vermilion", "purple", "black")
    return [COLOURS[order[index % len(order)]] for index in range(count)]


def _symbol(name: str) -> str:
    return _SYMBOLS.get(name, name)


def _title(dataset: xr.Dataset) -> str:
    formula, n_paths = dataset.attrs["formula"], dataset.attrs["n_paths"]
    return f"$B$ = {formula};  {n_paths} paths from equilibrium for each noise"
