"""Eigenvalues of the generator in the complex plane."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING

import numpy as np

from fpsolve._support.checks import check_kind
from fpsolve.model.fibre import FibreModel
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.plotting.style import COLOURS, COLUMN, LINES, MARKERS, drawing
from fpsolve.spectral.eigen.spectrum import Spectrum

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["plot_spectrum", "sector_label"]


def plot_spectrum(found: Spectrum) -> Figure:
    """Eigenvalues in the complex plane, by sector, and where the gap ends.

    Parameters
    ----------
    found : Spectrum
    """
    check_kind("found", found, Spectrum, "it is what `spectrum` returns")
    looks = zip(cycle(MARKERS), cycle(LINES), strict=True)
    with drawing(COLUMN, 2.8) as figure:
        axes = figure.subplots()
        sectors = np.array([str(sector) for sector in found.sectors])
        for name in dict.fromkeys(sectors.tolist()):
            values, (marker, colour) = found.eigenvalues[sectors == name], next(looks)
            axes.plot(
                values.real, values.imag, linestyle="none", label=sector_label(name),
                marker=marker, markersize=4.5, color=colour,
            )  # fmt: skip
        axes.plot(0, 0, "o", color=COLOURS["black"], markersize=4, label="stationary")
        axes.axvline(-found.gap, color="0.6", linewidth=0.8, linestyle="--")
        if found.essential is not None:
            axes.axvline(found.essential, color="0.3", linewidth=0.8, linestyle=":",
                         label="essential spectrum from here")  # fmt: skip
        model = found.model
        axes.set(
            xlabel=r"$\mathrm{Re}\,\lambda$",
            ylabel=r"$\mathrm{Im}\,\lambda$",
            title=f"$B$ = {model.potential.formula},  {amplitude(model)}",
        )
        bottom, top = axes.get_ylim()
        if top - bottom < 1e-6:
            axes.set_ylim(-0.5, 0.5)
        axes.legend(loc="best")
    return figure


def amplitude(model: FibreModel) -> str:
    """Return the noise, and the relaxation length of a smooth fibre."""
    words = f"$A$ = {model.noise:g}"
    if isinstance(model, SmoothLayDownModel):
        words += f",  $R$ = {model.relaxation_length:g}"
    return words


def sector_label(sector: str) -> str:
    """Return the sector with its index in italics."""
    return sector.replace("M = ", "$M$ = ")
