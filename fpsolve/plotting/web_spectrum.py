"""The power spectrum of a web: over all wave vectors, and along its sections."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve.plotting.style import (
    COLOURS,
    DENSITY_MAP,
    PAGE,
    drawing,
    show_frame,
)
from fpsolve.plotting.web_image import WebImage, holds_fibre, image_of
from fpsolve.web.statistics.estimate import Estimates
from fpsolve.web.statistics.spectrum import PowerSpectrum, power_spectrum

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["holds_blocks", "plot_web_spectrum"]

# Pixels of a side, of which four blocks of eight fit both ways.
_FEWEST = 32
# Powers of ten below the peak that the map shows.
_DECADES = 3.0


def plot_web_spectrum(web: Any, *, block: float | None = None) -> Figure:
    """P(k)/⟨m⟩ as a map, its mean over rings with error bars, and two sections.

    For independent fibres P/⟨m⟩ is the spectrum Ŝ of one; the line 2/‖k‖ is that of
    straight isotropic ones, and of all isotropic ones at large ‖k‖.

    Parameters
    ----------
    web : Web
    block : float, optional
        Side of the blocks, see `power_spectrum`.

    Raises
    ------
    TypeError, ValueError
        If it is no web, or as `power_spectrum`.
    """
    image = image_of(web)
    found = power_spectrum(image.density, image.pixel, block=block)
    with drawing(PAGE, 3.0, image.title) as figure:
        left, right = figure.subplots(1, 2, width_ratios=(1, 1.25))
        _draw_map(left, found, image)
        _draw_sections(right, found, image)
    return figure


def holds_blocks(web: Any) -> bool:
    """Whether a web is large enough for a spectrum with errors."""
    return min(web.length_density.shape) >= _FEWEST and holds_fibre(web)


def _draw_map(axes: Axes, found: PowerSpectrum, image: WebImage) -> None:
    from matplotlib.colors import LogNorm

    shown = found.power / found.mean
    _, factor = image.shown_unit
    peak = float(shown.max()) * factor
    if not peak > 0:
        axes.set_axis_off()
        return
    drawn = axes.pcolormesh(
        found.k1 / factor, found.k2 / factor,
        np.maximum(factor * shown, peak * 10**-_DECADES), cmap=DENSITY_MAP,
        norm=LogNorm(peak * 10**-_DECADES, peak), shading="nearest", rasterized=True,
    )  # fmt: skip
    show_frame(axes)
    axes.set(
        xlabel=_wave_number(image, "k_1"), ylabel=_wave_number(image, "k_2"),
        aspect="equal",
    )  # fmt: skip
    bar = axes.figure.colorbar(drawn, ax=axes, fraction=0.05, aspect=25, pad=0.02)
    bar.outline.set_linewidth(0.6)
    bar.set_label(_relative_power(image))


def _draw_sections(axes: Axes, found: PowerSpectrum, image: WebImage) -> None:
    from matplotlib.ticker import NullFormatter

    _, factor = image.shown_unit
    sections: list[tuple[Estimates, str, str]] = [
        (found.machine, r"$P(k_1, 0)$", "orange"),
        (found.cross, r"$P(0, k_2)$", "green"),
    ]
    for section, label, colour in sections:
        axes.plot(
            section.coordinate / factor, factor * section.values / found.mean,
            color=COLOURS[colour], linewidth=0.8, label=label,
        )  # fmt: skip
    radial = found.radial
    axes.errorbar(
        radial.coordinate / factor, factor * radial.values / found.mean,
        factor * radial.standard_errors / found.mean, color=COLOURS["blue"],
        marker="o", markersize=2.5, linewidth=0.9, label="mean over rings",
    )  # fmt: skip
    k = radial.coordinate
    axes.plot(k / factor, 2 * factor / k, "--", color="0.4", linewidth=0.9,
              label=r"$2/\|k\|$")  # fmt: skip
    axes.set(
        xscale="log", yscale="log", xlabel=_wave_number(image, r"\|k\|"),
        ylabel=_relative_power(image),
    )  # fmt: skip
    # Labels between powers of ten run into each other.
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.legend(loc="lower left")


def _wave_number(image: WebImage, name: str) -> str:
    return f"${name}$" + _in(image, "$^{-1}$")


def _relative_power(image: WebImage) -> str:
    return r"$P/\langle m\rangle$" + _in(image, "")


def _in(image: WebImage, power: str) -> str:
    unit, _ = image.shown_unit
    return f" in {unit}{power}" if unit else ""
