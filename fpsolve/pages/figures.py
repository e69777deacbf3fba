"""Figures as data URLs: drawings as SVG, what would be too large as PNG."""

from __future__ import annotations

import base64
import io
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from fpsolve.pages.blocks import Figure
from fpsolve.pages.captions import CAPTIONS
from fpsolve.results.kinds import kind_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Drawing

__all__ = ["drawings", "embedded"]

# A drawing of many thousand points is smaller, and faster to show, as a picture.
LARGEST_SVG = 600_000
# CSS pixels per inch, and how much larger than in print a figure is on a screen.
PIXELS_PER_INCH = 96
ENLARGEMENT = 1.25


def embedded(draw: Callable[[], Drawing], caption: str, alt: str) -> Figure:
    """Return what `draw` draws as a block of the page; the same bytes every time.

    Parameters
    ----------
    draw : callable
    caption : str
    alt : str
        What is to be seen, for readers who do not see it.
    """
    from fpsolve.plotting.style import paper_style

    with paper_style():
        drawing = draw()
        data, kind = _svg(drawing), "svg+xml"
        if len(data) > LARGEST_SVG:
            data, kind = _png(drawing), "png"
    source = f"data:image/{kind};base64,{base64.b64encode(data).decode('ascii')}"
    width = round(drawing.get_figwidth() * PIXELS_PER_INCH * ENLARGEMENT)
    return Figure(source, width, caption, alt)


def drawings(result: Any, variant: str = "") -> list[Figure]:
    """Return the figures that a result allows, with their captions, as blocks.

    Parameters
    ----------
    result : object
    variant : str
        What ends the names of captions of its own, where there are such.
    """
    from fpsolve.plotting.files import possible_figures

    found, kind = [], kind_of(result)
    for name, draw in possible_figures(result).items():
        usual = f"{kind}/{name}"
        words = CAPTIONS.get(usual + variant, CAPTIONS[usual])
        found.append(embedded(lambda draw=draw: draw(result), *words))  # type: ignore[misc]
    return found


def _svg(drawing: Drawing) -> bytes:
    import matplotlib as mpl

    buffer = io.BytesIO()
    # Without the salt the names in the file, without None its date, would be new
    # every time.
    with mpl.rc_context({"svg.hashsalt": "fpsolve"}):
        drawing.savefig(buffer, format="svg", metadata={"Date": None})
    return buffer.getvalue()


def _png(drawing: Drawing) -> bytes:
    from fpsolve.plotting.style import RESOLUTION

    buffer = io.BytesIO()
    drawing.savefig(buffer, format="png", dpi=RESOLUTION)
    return buffer.getvalue()
