"""Fibres that were measured or simulated, as they lie on the belt."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fpsolve._support.checks import check_kind
from fpsolve.paths.fibres.fibre_curve import FibreCurve
from fpsolve.plotting.fibres import THIN
from fpsolve.plotting.style import COLOURS, COLUMN, drawing, show_frame

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["plot_fibre_curve"]

# Points of which a line is drawn: more are black on the paper.
MOST_POINTS = 4000


def plot_fibre_curve(fibre: FibreCurve, k: int = 0) -> Figure:
    """The beginning of fibre η on the belt, with its reference curve γ if it is known.

    Parameters
    ----------
    fibre : FibreCurve
    k : int, optional
        Which of several fibres.
    """
    check_kind("fibre", fibre, FibreCurve, "make one by FibreCurve(eta, ds)")
    eta, s = fibre.pieces[k][:MOST_POINTS], fibre.arclengths[k][:MOST_POINTS]
    with drawing(COLUMN, 2.6) as figure:
        axes = figure.subplots()
        axes.plot(*eta.T, color=COLOURS["blue"], linewidth=THIN, label=r"fibre $\eta$")
        if fibre.curve is not None:
            curve = np.stack(fibre.curve.position(s), axis=-1)
            marker = "." if np.ptp(curve) == 0 else None
            axes.plot(
                *curve.T, color=COLOURS["vermilion"], linewidth=0.9, marker=marker,
                label=r"reference curve $\gamma$",
            )  # fmt: skip
            figure.legend(loc="outside lower right", ncols=2)
        axes.set_aspect("equal")
        axes.set(xlabel=r"$\eta_1$", ylabel=r"$\eta_2$")
        axes.set_title(length_shown(s[-1] - s[0], fibre.length))
        show_frame(axes)
    return figure


def length_shown(shown: float, whole: float) -> str:
    """How long the drawn part is, and all pieces where these are more than it."""
    if np.isclose(shown, whole, rtol=1e-9):
        return f"length {whole:.4g}"
    return f"length {shown:.4g} of {whole:.4g}"
