"""What figures of a web show: its density, the unit of length, a scale bar."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_kind, check_positive
from fpsolve.plotting.style import parameters
from fpsolve.web.statistics.fields import check_density, check_orientation
from fpsolve.web.web import Web

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = [
    "WebImage",
    "add_scale_bar",
    "checked_opacity",
    "draw_light",
    "holds_fibre",
    "image_of",
    "round_length",
]

# Share of the length of a web that its scale bar has at most.
_BAR = 0.25
# Of a figure, so that long webs stay legible and wide ones stay on the page.
_LOWEST, _HIGHEST = 0.18, 1.2
# Light that passes where there is as much fibre as in the mean.
_MEAN_LIGHT = 0.55


@dataclass(frozen=True, eq=False)
class WebImage:
    """The density of a web with what its axes need to say.

    Parameters
    ----------
    density : array
        Laid length per area, cross × machine direction, in the unit of `pixel`.
    pixel : float
        Side of a pixel.
    unit : str
        Unit of length, "m" or empty for the dimensionless ones.
    mass : array, optional
        g/m² of every pixel, where the titer is known.
    orientation : array, optional
        ⟨τ⊗τ⟩ of every pixel.
    title : str
        Parameters, for the title of a figure.
    """

    density: Array
    pixel: float
    unit: str = ""
    mass: Array | None = None
    orientation: Array | None = None
    title: str = ""

    def __post_init__(self) -> None:
        check_density(self.density, self.pixel)
        if self.orientation is not None:
            check_orientation(self.orientation, self.density)

    @property
    def shown_unit(self) -> tuple[str, float]:
        """Unit of lengths in figures, and how many of it the pixel's unit has."""
        return ("mm", 1e3) if self.unit == "m" else (self.unit, 1.0)

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """Machine direction from and to, cross direction from and to, as shown."""
        _, factor = self.shown_unit
        width, length = (n * self.pixel * factor for n in self.density.shape)
        return 0.0, length, 0.0, width

    def height(self, width: float) -> float:
        """Height of a figure of that width that fits the web, as far as it may."""
        ratio = self.density.shape[0] / self.density.shape[1]
        return width * float(np.clip(ratio, _LOWEST, _HIGHEST))

    def label(self, direction: str) -> str:
        """Name of an axis, with its unit if it has one."""
        unit, _ = self.shown_unit
        return f"{direction} direction" + (f" in {unit}" if unit else "")


def image_of(web: Any) -> WebImage:
    """Return what figures show of a web; TypeError if it is none."""
    if isinstance(web, WebImage):
        return web
    check_kind("web", web, Web, "it is what `lay_web` returns")
    return WebImage(
        web.length_density, web.pixel, web.unit, web.mass_density, web.orientation,
        _title(web),
    )  # fmt: skip


def holds_fibre(web: Web) -> bool:
    """Whether there is anything to see."""
    return bool(web.length_density.max() > 0)


def _title(web: Web) -> str:
    """Return the parameters, the spacing, and the base weight if it is known."""
    if not web.unit:
        return f"{parameters(web)},  $d = {web.spacing:g}$"
    # On a line of its own, without which a column is too narrow.
    spacing = f"$d = {1e3 * web.spacing:.4g}$ mm"
    if web.base_weight is not None:
        spacing += f",  {web.base_weight:.3g} g/m²"
    return f"{parameters(web)}\n{spacing}"


def checked_opacity(opacity: float | None, image: WebImage) -> float:
    """Return c of exp(-c m); by default the mean density lets 55 % of light pass."""
    if opacity is not None:
        return check_positive("opacity", opacity)
    return -math.log(_MEAN_LIGHT) / float(image.density.mean())


def draw_light(axes: Axes, image: WebImage, opacity: float, **options: Any) -> None:
    """Draw exp(-c m), the light that passes a web, in grey."""
    axes.imshow(
        np.exp(-opacity * image.density), cmap="gray", vmin=0.0, vmax=1.0,
        origin="lower", extent=image.extent, **options,
    )  # fmt: skip


def round_length(longest: float) -> float:
    """1, 2 or 5 times a power of ten, the largest that is not longer."""
    power = 10.0 ** math.floor(math.log10(longest))
    # Rounding may leave 0.9999 of a whole number.
    steps = [step for step in (1, 2, 5) if step * power <= longest * (1 + 1e-9)]
    return max(steps) * power


def add_scale_bar(axes: Axes, image: WebImage, distance: float = 0.03) -> float:
    """Draw a bar of a round length below the web with its label; return the length.

    Parameters
    ----------
    axes : Axes
        With the web.
    image : WebImage
        The web.
    distance : float
        From the web down to the bar, relative to its width.
    """
    unit, _ = image.shown_unit
    length, width = image.extent[1], image.extent[3]
    bar = round_length(_BAR * length)
    below = -distance * width
    axes.plot(
        [length - bar, length], [below, below], color="black", linewidth=2.0,
        solid_capstyle="butt", clip_on=False,
    )  # fmt: skip
    # The bar lies outside, and shall not move the edges.
    axes.set(xlim=image.extent[:2], ylim=image.extent[2:])
    # It ends with the bar: a label that is longer would leave a narrow picture.
    axes.annotate(
        f"{bar:g} {unit}" if unit else f"length {bar:g}",
        (length, below), (0, -4), textcoords="offset points",
        ha="right", va="top", annotation_clip=False,
    )  # fmt: skip
    return bar
