"""What was traded in the design of a web, and what its variation depends on."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fpsolve._support.checks import check_kind
from fpsolve.plotting.logarithmic import plain_numbers
from fpsolve.plotting.style import COLOURS, LINES, PAGE, drawing
from fpsolve.studies.design.result import WebDesign

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["plot_web_design"]

# Of ticks in a decade, all of them on short axes, and the ratio above which only powers
# of ten are told.
_DIGITS, _ALL, _SHORT, _RATIO = (1, 2, 5), tuple(range(1, 10)), 8.0, 300.0
# Of an axis that shows one number, and less than the whole of a bar.
_ROOM, _BAR = 1.1, 0.8
# What sensitivities are called: the titer has none.
_SYMBOLS = {
    "noise": "$A$", "sigma1": r"$\sigma_1$", "sigma2": r"$\sigma_2$",
    "speed_ratio": "$v$", "spacing": "$d$", "relaxation_length": "$R$",
}  # fmt: skip


def plot_web_design(design: WebDesign) -> Figure:
    """CV of zones against throughput, and ∂ log CV/∂ log θ at the optimum.

    Lines are the front, where there is one, else the way of the search; circles the
    start, stars the optimum, squares with two standard errors what was laid there, and
    dotted the bounds of CV.

    Parameters
    ----------
    design : WebDesign
    """
    check_kind("design", design, WebDesign, "it is what `design_web` returns")
    title = f"{design.base_weight:.4g} g/m², {design.positions} positions"
    with drawing(PAGE, 3.0, title) as figure:
        trade, slopes = figure.subplots(1, 2)
        _trade_off(trade, design)
        _sensitivities(slopes, design)
    return figure


def _trade_off(axes: Axes, design: WebDesign) -> None:
    rows, cv, label = design.front_throughput, design.front_cv, "front"
    if not rows.size:
        rows, cv, label = design.history_throughput, design.history_cv, "search"
    axes.set(xscale="log", yscale="log")
    for n, zone in enumerate(design.zones):
        colour = LINES[n % len(LINES)]
        axes.plot(rows, 100 * cv[:, n], color=colour, marker=".", markersize=3,
                  label=f"{label}, {1e3 * zone:g} mm")  # fmt: skip
        start = design.history_throughput[0], 100 * design.history_cv[0, n]
        axes.plot(*start, "o", color=colour, fillstyle="none", markersize=5)
        axes.plot(design.throughput, 100 * design.cv[n], "*", color=colour,
                  markersize=9)  # fmt: skip
        if design.n_webs:
            axes.errorbar(
                design.throughput, 100 * design.simulated[n],
                200 * design.standard_errors[n], color=COLOURS["black"], capsize=3,
                linewidth=0.8, fmt="s", markersize=3, zorder=3,
            )  # fmt: skip
        if design.bounded:
            axes.axhline(100 * design.largest[n], color=colour, linestyle=":")
    _with_room(axes, [*rows, design.throughput, design.history_throughput[0]])
    axes.set(xlabel="throughput in kg/h per metre", ylabel="CV in %")
    for axis in (axes.xaxis, axes.yaxis):
        low, high = axis.get_view_interval()
        plain_numbers(axis, _ALL if high < _SHORT * low else _DIGITS, _RATIO)
    axes.legend(loc="best")


def _with_room(axes: Axes, shown: list[float]) -> None:
    """Leave room on both sides, also where all throughputs are the same."""
    axes.set_xlim(min(shown) / _ROOM, max(shown) * _ROOM)


def _sensitivities(axes: Axes, design: WebDesign) -> None:
    width = _BAR / design.zones.size
    symbols = {
        name: symbol for name, symbol in _SYMBOLS.items()
        if name != "relaxation_length" or design.process.relaxation_length
    }  # fmt: skip
    order = [design.parameters.index(name) for name in symbols]
    places = np.arange(float(len(order)))
    for n, zone in enumerate(design.zones):
        axes.bar(
            places + (n + 0.5) * width - 0.5 * _BAR, design.sensitivities[order, n],
            width, yerr=design.sensitivity_errors[order, n],
            color=LINES[n % len(LINES)], error_kw={"linewidth": 0.6},
            label=f"{1e3 * zone:g} mm",
        )  # fmt: skip
    axes.axhline(0.0, color="0.5", linewidth=0.6)
    axes.set_xticks(places, list(symbols.values()))
    axes.set_ylabel(r"$\partial\,\log$ CV$/\partial\,\log\theta$")
    axes.legend(loc="best")
