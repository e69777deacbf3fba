"""How all figures look: sizes, fonts, colours, and the titles that state parameters."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fpsolve.model.fibre import FibreModel

__all__ = [
    "COLOURS",
    "COLUMN",
    "DENSITY_MAP",
    "LINES",
    "MARKERS",
    "PAGE",
    "RESOLUTION",
    "drawing",
    "formula",
    "legend_above",
    "new_figure",
    "noise_of",
    "paper_style",
    "parameters",
    "show_frame",
]

# Widths in inches of one column and of a page of a journal.
COLUMN, PAGE = 3.4, 7.0
# Dots per inch of a PNG.
RESOLUTION = 200

# Okabe and Ito's colours, told apart by colour-blind readers; yellow is left out, it
# is too pale for a line.
COLOURS = {
    "black": "#000000",
    "blue": "#0072B2",
    "orange": "#E69F00",
    "green": "#009E73",
    "vermilion": "#D55E00",
    "sky": "#56B4E9",
    "purple": "#CC79A7",
}
# Of lines and of points, in the order in which they are taken.
LINES = [colour for name, colour in COLOURS.items() if name != "black"]
MARKERS = "osD^vP"
# Perceptually uniform, and safe for all kinds of colour vision.
DENSITY_MAP = "viridis"

_SETTINGS: dict[Any, Any] = {
    "font.size": 8.5,
    "axes.titlesize": 8.5,
    "axes.labelsize": 9,
    "figure.titlesize": 9,
    "legend.fontsize": 8,
    "legend.frameon": False,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "axes.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "lines.linewidth": 1.2,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "mathtext.fontset": "dejavusans",
    "legend.handlelength": 1.8,
}


_styled: ContextVar[bool] = ContextVar("styled", default=False)


@contextmanager
def paper_style() -> Iterator[None]:
    """Set fonts and lines for the figures drawn inside, whatever the user's style."""
    import matplotlib as mpl

    # Setting all parameters takes 20 ms, which five figures would spend twenty times.
    if _styled.get():
        yield
        return
    token = _styled.set(True)
    try:
        with mpl.rc_context():
            mpl.rcdefaults()
            mpl.rcParams.update(_SETTINGS)
            yield
    finally:
        _styled.reset(token)


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure of that size in inches, outside of pyplot."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), dpi=RESOLUTION, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


@contextmanager
def drawing(width: float, height: float, title: str = "") -> Iterator[Figure]:
    """Give an empty figure to draw on in the style of all; its title comes last."""
    with paper_style():
        figure = new_figure(width, height)
        yield figure
        if title:
            figure.suptitle(title)


def noise_of(model: FibreModel) -> str:
    """Return the noise, and the relaxation length of a smooth model."""
    noise, length = f"$A = {model.noise:g}$", getattr(model, "relaxation_length", None)
    return noise if length is None else f"{noise},  $R = {length:g}$"


def parameters(owner: Any) -> str:
    """Return potential, noise and curve of what has a model, for the title of a figure.

    A curve with a long formula comes on a line of its own.
    """
    model = getattr(owner, "model", None)
    # It could not be read back.
    if model is None:
        return r"$B$ from the user's own functions"
    potential = formula(model.potential)
    title = rf"$B =$ {potential},  {noise_of(model)}"
    if model.curve.fixed:
        return title
    if model.curve.autonomous:
        return rf"{title},  $v = {model.belt_speed:g}$"
    return f"{title},\n$\\gamma(s) =$ {formula(model.curve)}"


def formula(shown: Any) -> str:
    """Return the formula of a potential or of a curve."""
    return _readable(shown.latex, shown.formula)


@cache
def _readable(latex: str, plain: str) -> str:
    """Return the formula for matplotlib, which knows only a part of LaTeX."""
    from matplotlib.mathtext import MathTextParser

    latex = re.sub(r"\\frac(\d)(\d)", r"\\frac{\1}{\2}", latex)
    try:
        MathTextParser("path").parse(f"${latex}$")
    except ValueError:
        return plain
    return f"${latex}$"


def legend_above(axes: Axes, share: float) -> None:
    """Put the legend at the top, with that share of the height kept free for it."""
    bottom, top = axes.get_ylim()
    axes.set_ylim(bottom, bottom + (top - bottom) / (1 - share))
    axes.legend(loc="upper right", borderaxespad=0.2)


def show_frame(axes: Axes) -> None:
    """Draw the sides of a panel that curves leave open."""
    for side in ("top", "right"):
        axes.spines[side].set_visible(True)
