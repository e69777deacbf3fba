"""A web as a PNG, pixel by pixel, with a scale bar."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from fpsolve._support.checks import check_path
from fpsolve._support.files import atomic_path
from fpsolve.plotting.style import new_figure, paper_style
from fpsolve.plotting.web_image import (
    add_scale_bar,
    checked_opacity,
    draw_light,
    image_of,
)

__all__ = ["check_picture", "save_web_png"]

# Dots per inch of the drawing; of text and bar only, pixels stay pixels.
_DOTS = 100
# Pixels that the strip with the scale bar takes, and the widest picture of Agg.
_STRIP, _WIDEST = 40, 2**16 - 1
# Of a picture, for its scale bar to be legible.
_NARROWEST = 40


def save_web_png(
    web: Any, path: str | os.PathLike[str], *, opacity: float | None = None
) -> Path:
    """Write transmitted light exp(-c m), one dot for a pixel, and a scale bar below.

    The machine direction runs to the right, the cross direction upwards.

    Parameters
    ----------
    web : Web
    path : str or os.PathLike
        File to write; it appears whole or not at all.
    opacity : float, optional
        c; by default such that the mean density lets 55 % of the light pass.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    TypeError, ValueError
        If it is no web, has fewer than 40 pixels along the machine or 65535 pixels or
        more along a side, or the opacity is not positive.
    """
    image, path = image_of(web), check_path("path", path)
    opacity = checked_opacity(opacity, image)
    n_cross, n_machine = image.density.shape
    check_picture(n_cross, n_machine)
    height = n_cross + _STRIP
    with paper_style():
        figure = new_figure(n_machine / _DOTS, height / _DOTS)
        figure.set_layout_engine("none")
        axes = figure.add_axes((0.0, _STRIP / height, 1.0, n_cross / height))
        axes.set_axis_off()
        draw_light(axes, image, opacity, interpolation="none", aspect="auto")
        add_scale_bar(axes, image, 8.0 / n_cross)
        with atomic_path(path) as draft:
            figure.savefig(draft, dpi=_DOTS, format="png")
    return path


def check_picture(n_cross: int, n_machine: int) -> None:
    """Raise ValueError unless a web of so many pixels can be a PNG with its bar."""
    if not (n_machine >= _NARROWEST and max(n_cross + _STRIP, n_machine) < _WIDEST):
        raise ValueError(
            f"`web` must have {_NARROWEST} to {_WIDEST - _STRIP - 1} pixels along a "
            f"side of its picture, got {n_cross} × {n_machine}; use `to_tiff`, or lay "
            "it with other pixels."
        )
