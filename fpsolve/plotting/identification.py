"""Fibres of identified models beside the one that was measured: figures 8 and 9."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_kind
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.plotting.fibres import THIN
from fpsolve.plotting.style import COLOURS, PAGE, drawing, show_frame
from fpsolve.studies.identification.comparison import IdentificationComparison
from fpsolve.studies.identification.identification import Identification
from fpsolve.studies.identification.surrogate import Surrogate

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["plot_identified_fibres", "plot_increments"]

# Length of the fibres that are drawn, in units of the larger σ, and points at most.
LENGTH, MOST_POINTS = 100.0, 5000
# Labels of fibres in metres are long.
FEW_TICKS = 4
# Of the models in their order; the data are black.
_COLOURS = ("vermilion", "blue", "green")
_HINT = "it is what `identify` or `compare_models` returns"


def plot_identified_fibres(
    identification: Identification | IdentificationComparison,
    *others: Identification,
    seed: int = 0,
) -> Figure:
    """The fibre on the belt and fibres of the identified models, as in figure 8.

    Parameters
    ----------
    identification : Identification or IdentificationComparison
        What `identify` or `compare_models` returns.
    *others : Identification
        Other models of the same fibre, as the basic beside the smooth one.
    seed : int, optional
        Of the fibres of the models.

    References
    ----------
    [KMW09]_, figure 8.
    """
    several = _checked(identification, *others)
    n = _n_points(several[0])
    eta = several[0].data.pieces[0][:n]
    fibres = [("data", eta)] + [
        (_name(one), _drawn(one, len(eta), seed)) for one in several
    ]
    with drawing(PAGE, 2.6) as figure:
        panels = figure.subplots(1, len(fibres), sharex=True, sharey=True)
        for axes, (name, points), colour in zip(
            panels, fibres, ("black", *_COLOURS), strict=False
        ):
            axes.plot(*points.T, color=COLOURS[colour], linewidth=THIN)
            axes.set(title=name, xlabel=r"$\eta_1$")
            axes.set_aspect("equal")
            axes.locator_params(axis="x", nbins=FEW_TICKS)
            show_frame(axes)
        panels[0].set_ylabel(r"$\eta_2$")
    return figure


def plot_increments(
    identification: Identification | IdentificationComparison, *others: Identification
) -> Figure:
    """Increments Γ_α(h), Γ_κ(h) of the fibre and of identified models, as in figure 9.

    Bands hold 95 % of the model's own fibres of the size of the data.

    Parameters
    ----------
    identification : Identification or IdentificationComparison
        What `identify` or `compare_models` returns.
    *others : Identification
        Other models of the same fibre.

    References
    ----------
    [KMW09]_, figure 9.
    """
    several = _checked(identification, *others)
    with drawing(PAGE, 2.7) as figure:
        panels = figure.subplots(1, 2)
        for axes, symbol, name in zip(
            panels, ("α", "κ"), ("angle_bands", "curvature_bands"), strict=True
        ):
            _draw_bands(axes, several, name)
            axes.set(xlabel="$h$", ylabel=rf"$\Gamma_{{{symbol}}}$", ylim=(0, None))
            axes.locator_params(axis="x", nbins=FEW_TICKS)
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return figure


def _draw_bands(axes: Axes, several: list[Identification], name: str) -> None:
    first = several[0]
    axes.plot(first.h, getattr(first, name)[0], ".", markersize=3,
              color=COLOURS["black"], label="data")  # fmt: skip
    for one, colour in zip(several, _COLOURS, strict=False):
        _, mean, low, high = getattr(one, name)
        axes.plot(one.h, mean, color=COLOURS[colour], label=_name(one))
        axes.fill_between(one.h, low, high, color=COLOURS[colour], alpha=0.25,
                          linewidth=0)  # fmt: skip


def _checked(
    first: Identification | IdentificationComparison, *others: Identification
) -> list[Identification]:
    """All of them; of a comparison both."""
    if isinstance(first, IdentificationComparison):
        several = [*first.identifications.values(), *others]
    else:
        several = [first, *others]
    for one in several:
        check_kind("identification", one, Identification, _HINT)
    return several


def _name(one: Identification) -> str:
    return "smooth" if isinstance(one.model, SmoothLayDownModel) else "basic"


def _n_points(one: Identification) -> int:
    sigma = max(one.parameters["sigma1"], one.parameters["sigma2"])
    return min(round(LENGTH * sigma / one.data.ds), MOST_POINTS)


def _drawn(one: Identification, n: int, seed: int) -> Array:
    """The first of the fibres of a model, at the arclengths of the data."""
    sample = Surrogate(one.data, seed).sample(one.model, n)
    s = one.data.arclengths[0][:n]
    return sample.xi[:, 0] + np.stack(one.model.curve.position(s), axis=-1)
