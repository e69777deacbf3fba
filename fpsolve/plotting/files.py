"""All figures of a solution as PNG files."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from fpsolve.io.atomic import atomic_path
from fpsolve.plotting.angle import plot_angle
from fpsolve.plotting.entropy import has_entropy, plot_entropy
from fpsolve.plotting.marginals import plot_marginals
from fpsolve.plotting.moments import plot_moments
from fpsolve.plotting.overview import plot_overview
from fpsolve.plotting.style import RESOLUTION, paper_style
from fpsolve.solution import Solution

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["save_figures"]


def save_figures(
    solution: Solution, directory: str | os.PathLike[str], *, prefix: str = ""
) -> list[Path]:
    """Write every figure that the solution allows as a PNG of 200 dots per inch.

    Parameters
    ----------
    solution : Solution
    directory : str or os.PathLike
        Folder to write to; made if it does not exist.
    prefix : str
        Beginning of the file names.

    Returns
    -------
    list of Path
        The files written: `overview.png`, `marginals.png` and `angle.png` if a density
        was saved, `entropy.png` if there is a relative entropy, and `moments.png`. Each
        appears complete or not at all.
    """
    directory = Path(directory)
    directory.mkdir(parents=True, exist_ok=True)
    return [
        _write(plot(solution), directory / f"{prefix}{name}.png")
        for name, plot in _possible_figures(solution).items()
    ]


def _possible_figures(solution: Solution) -> dict[str, Callable[[Solution], Figure]]:
    figures: dict[str, Callable[[Solution], Figure]] = {}
    if len(solution.saved_s):
        figures["overview"] = plot_overview
        figures["marginals"] = plot_marginals
        figures["angle"] = plot_angle
    if has_entropy(solution):
        figures["entropy"] = plot_entropy
    if len(solution.series["s"]):
        figures["moments"] = plot_moments
    return figures


def _write(figure: Figure, path: Path) -> Path:
    with paper_style(), atomic_path(path) as draft:
        figure.savefig(draft, dpi=RESOLUTION)
    return path
