"""The homogeneity of a predicted web against the size of the zones."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fpsolve._support.checks import check_kind
from fpsolve.plotting.logarithmic import plain_numbers
from fpsolve.plotting.style import COLOURS, COLUMN, drawing
from fpsolve.web.prediction import WebPrediction

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["plot_predicted_web"]

# Of ticks in a decade, and the ratio above which only powers of ten are told.
DIGITS, RATIO = (1, 2, 5), 300.0


def plot_predicted_web(prediction: WebPrediction) -> Figure:
    """CV = √(v d ∫ Ŝ |ŵ|² d²k/(2π)² + coherent part) of square zones by their side.

    Dashed the law of zones so small that fibres cross them as straight lines.

    Parameters
    ----------
    prediction : WebPrediction
    """
    words = "it is what `predict_web` returns"
    check_kind("prediction", prediction, WebPrediction, words)
    order = np.argsort(prediction.zones)
    zones = prediction.zones[order]
    with drawing(COLUMN, 2.8) as figure:
        axes = figure.subplots()
        axes.errorbar(
            zones, 100 * prediction.cv[order], 100 * prediction.errors[order],
            marker="o", markersize=3.5, color=COLOURS["blue"], label="predicted",
        )  # fmt: skip
        if prediction.model is not None:
            law = 100 * prediction.small_zone_law()[order]
            axes.plot(zones, law, "--", color="0.5", label="straight fibres")
        axes.set(xscale="log", yscale="log")
        axes.set(xlabel="side of the zone $x$", ylabel="CV in %")
        axes.set_title(
            f"$d$ = {prediction.spacing:g}, {prediction.positions} positions"
        )
        plain_numbers(axes.xaxis, DIGITS, RATIO)
        plain_numbers(axes.yaxis, DIGITS, RATIO)
        axes.legend(loc="best")
    return figure
