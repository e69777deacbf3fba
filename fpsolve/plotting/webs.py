"""A web as it looks against light, and the map of its mass."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve.plotting.style import DENSITY_MAP, PAGE, drawing, show_frame
from fpsolve.plotting.web_image import (
    add_scale_bar,
    checked_opacity,
    draw_light,
    image_of,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

__all__ = ["plot_mass", "plot_web"]

# In inches above and below a map, and beside one with axes and colour bar.
_AROUND, _BESIDE = 0.55, 1.35
# Of a title, for each line but the first.
_LINE = 0.17
# In per cent; the few pixels with more, where fibres cross, share one colour.
_BRIGHTEST = 99.5


def plot_web(
    web: Any, *, opacity: float | None = None, titles: Sequence[str] | None = None
) -> Figure:
    """Transmitted light, exp(-c m) in grey: webs as on figures 10 and 11.

    The machine direction runs to the right. Several webs are drawn below each other in
    the grey scale of the first, and belong to one length and width.

    Parameters
    ----------
    web : Web or sequence of Web
    opacity : float, optional
        c; by default such that the mean density of the first web lets 55 % of the
        light pass.
    titles : sequence of str, optional
        One above each web.

    Raises
    ------
    TypeError
        If it is no web.
    ValueError
        If the opacity is not positive, or there are not as many titles as webs.
    """
    webs = web if isinstance(web, list | tuple) else [web]
    images = [image_of(one) for one in webs]
    if not images:
        raise ValueError("`web` must be a web or some of them, got none.")
    opacity = checked_opacity(opacity, images[0])
    titles = [image.title for image in images] if titles is None else list(titles)
    if len(titles) != len(images):
        raise ValueError(
            f"`titles` must be one for each of {len(images)} webs, got {len(titles)}."
        )
    height = sum(image.height(PAGE) + _AROUND for image in images)
    height += _LINE * sum(title.count("\n") for title in titles)
    with drawing(PAGE, height) as figure:
        panels = figure.subplots(len(images), 1, squeeze=False)[:, 0]
        for axes, image, title in zip(panels, images, titles, strict=True):
            draw_light(axes, image, opacity, interpolation="antialiased")
            axes.set(xticks=[], yticks=[], title=title)
            show_frame(axes)
            add_scale_bar(axes, image)
    return figure


def plot_mass(web: Any) -> Figure:
    """The mass per area of a web in g/m², or its laid length per area, with a scale.

    Parameters
    ----------
    web : Web

    Raises
    ------
    TypeError
        If it is no web.
    """
    image = image_of(web)
    shown, label = image.density, "laid length per area"
    if image.unit:
        label += f" in {image.unit}$^{{-1}}$"
    if image.mass is not None:
        shown, label = image.mass, "mass per area in g/m²"
    height = image.height(PAGE - _BESIDE) + _AROUND
    with drawing(PAGE, height, image.title) as figure:
        axes = figure.subplots()
        drawn = axes.imshow(
            shown, cmap=DENSITY_MAP, vmin=0.0, vmax=np.percentile(shown, _BRIGHTEST),
            origin="lower", extent=image.extent, interpolation="antialiased",
        )  # fmt: skip
        show_frame(axes)
        axes.set(xlabel=image.label("machine"), ylabel=image.label("cross"))
        bar = figure.colorbar(
            drawn, ax=axes, fraction=0.05, aspect=25, pad=0.02, extend="max"
        )
        bar.set_label(label)
        bar.outline.set_linewidth(0.6)
    return figure
