"""How even a web is: the variation of its zones, and where its fibres run."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.arrays import Array, check_finite_numbers
from fpsolve.plotting.logarithmic import plain_numbers
from fpsolve.plotting.style import COLOURS, COLUMN, drawing
from fpsolve.plotting.web_image import WebImage, holds_fibre, image_of, round_length
from fpsolve.web.statistics.estimate import Estimates
from fpsolve.web.statistics.formation import STRAIGHT_FIBRES
from fpsolve.web.statistics.orientation import orientation_rose
from fpsolve.web.statistics.zones import coefficient_of_variation

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["holds_zones", "plot_rose", "plot_variation", "zones_for"]

# Zones across the shorter side of a web, at least, for a curve with errors.
_FEWEST_ZONES = 4
# Of ticks in a decade, and the ratio above which only powers of ten are told.
_DIGITS, _RATIO = (1, 2, 5), 300.0


def plot_variation(
    web: Any, zones: Any = None, *, predicted: tuple[Any, Any] | None = None
) -> Figure:
    """CV of square zones against their side, with standard errors.

    Beside it the law of random straight fibres of the same mean, 0.973 (⟨m⟩ x)^-½.

    Parameters
    ----------
    web : Web
    zones : sequence of float, optional
        Sides in the unit of the pixel; by default 1, 2 and 5 times powers of ten.
    predicted : pair of sequences, optional
        Sides and CV of a prediction, drawn as a line.

    Raises
    ------
    TypeError, ValueError
        If it is no web, or as `coefficient_of_variation`.
    """
    image = image_of(web)
    zones = zones_for(image) if zones is None else zones
    found = coefficient_of_variation(image.density, image.pixel, np.atleast_1d(zones))
    assert isinstance(found, Estimates)
    with drawing(COLUMN, 2.8, image.title) as figure:
        axes = figure.subplots()
        _draw_straight_fibres(axes, image, found.coordinate)
        _, factor = image.shown_unit
        if predicted is not None:
            sides, variation = (
                check_finite_numbers("predicted", part) for part in predicted
            )
            axes.plot(
                factor * sides, variation, color=COLOURS["vermilion"], label="predicted"
            )
        # Where an error is not known there is a point without a bar.
        errors = np.nan_to_num(found.standard_errors)
        axes.errorbar(
            factor * found.coordinate, found.values, errors, linestyle="none",
            marker="o", markersize=4, color=COLOURS["blue"], capsize=2,
            label="this web",
        )  # fmt: skip
        axes.set(xscale="log", yscale="log", ylabel="coefficient of variation")
        axes.set_xlabel(image.label("side of the zones").replace(" direction", ""))
        # 1, 2, 5 of every decade, as the sides that are chosen by default.
        for axis in (axes.xaxis, axes.yaxis):
            plain_numbers(axis, _DIGITS, _RATIO)
        axes.legend(loc="best")
    return figure


def plot_rose(web: Any, *, n_bins: int = 36) -> Figure:
    """The density of laid length over directions, and that of an isotropic web.

    The machine direction points to the right.

    Parameters
    ----------
    web : Web
    n_bins : int
        Bins of a half turn.

    Raises
    ------
    TypeError, ValueError
        If it is no web or has no orientation, or as `orientation_rose`.
    """
    image = image_of(web)
    if image.orientation is None:
        raise ValueError("`web` must have an orientation for a rose, got none.")
    rose = orientation_rose(
        image.density, image.pixel, image.orientation, n_bins=n_bins
    )
    # A fibre has no head: every direction is drawn with its opposite.
    angles = np.concatenate([rose.coordinate, rose.coordinate + np.pi])
    with drawing(COLUMN, 3.2, image.title) as figure:
        axes: Any = figure.subplots(subplot_kw={"projection": "polar"})
        axes.bar(
            angles, np.tile(rose.values, 2), np.pi / n_bins, color=COLOURS["sky"],
            edgecolor="white", linewidth=0.4, yerr=np.tile(rose.standard_errors, 2),
            error_kw={"elinewidth": 0.6, "ecolor": "0.3"},
        )  # fmt: skip
        turn = np.linspace(0, 2 * np.pi, 361)
        axes.plot(
            turn, np.full(turn.shape, 1 / np.pi), color=COLOURS["black"],
            linewidth=0.9, linestyle="--", label="isotropic",
        )  # fmt: skip
        axes.set_xticks(np.arange(4) * np.pi / 2, ["MD", "CD", "", ""])
        axes.set_rlabel_position(68)
        axes.grid(linewidth=0.4)
        figure.legend(loc="outside lower center")
    return figure


def holds_zones(web: Any) -> bool:
    """Whether two pixels lie in a web, of which there is a variation."""
    return web.length_density.size >= 2 and holds_fibre(web)


def zones_for(image: WebImage) -> Array:
    """Return 1, 2 and 5 times powers of ten between the pixel and the web, in order."""
    longest = image.pixel * min(image.density.shape) / _FEWEST_ZONES
    zones: list[float] = []
    while longest >= image.pixel:
        zones.insert(0, round_length(longest))
        longest = 0.9 * zones[0]
    kept = [zone for zone in zones if zone >= image.pixel]
    return np.array(kept or [image.pixel])


def _draw_straight_fibres(axes: Axes, image: WebImage, zones: Array) -> None:
    law = np.sqrt(STRAIGHT_FIBRES / (image.density.mean() * zones))
    _, factor = image.shown_unit
    axes.plot(
        factor * zones, law, color="0.5", linestyle="--",
        linewidth=0.9, label="straight fibres",
    )  # fmt: skip
