"""Logarithmic axes: ticks that are plain numbers, and room for a legend."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis

__all__ = ["legend_with_room", "noise_ticks", "plain_numbers"]


def plain_numbers(axis: Axis, digits: Sequence[int], ratio: float) -> None:
    """Label 0.2, 0.5, 1, … and not 5 x 10⁻¹; only powers of ten beyond a ratio."""
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

    low, high = axis.get_view_interval()
    shown = digits if high < ratio * low else [1]
    candidates = np.outer(10.0 ** np.arange(-9, 10), shown).ravel()
    inside = (candidates >= low) & (candidates <= high)
    axis.set_major_locator(FixedLocator(candidates[inside].tolist()))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_locator(NullLocator())


def noise_ticks(axes: Axes, noises: np.ndarray) -> None:
    """Ticks at the noises themselves."""
    axes.set_xticks(noises, [f"{noise:g}" for noise in noises])
    axes.minorticks_off()


def legend_with_room(axes: Axes, **options: Any) -> None:
    """Put a legend at the top, if there is one, with a part of the height for it."""
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="upper center", ncols=2, **options)
        bottom, top = axes.get_ylim()
        axes.set_ylim(bottom, top * (top / bottom) ** 0.3)
