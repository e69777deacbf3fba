"""All figures of a result as PNG files."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fpsolve._support.files import atomic_path, made_folder
from fpsolve.plotting.kinds import FIGURES
from fpsolve.plotting.style import RESOLUTION, paper_style
from fpsolve.results.kinds import kind_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["possible_figures", "save_figures", "write_figure"]


def save_figures(
    result: Any, directory: str | os.PathLike[str], *, prefix: str = ""
) -> list[Path]:
    """Write every figure that the result allows as a PNG of 200 dots per inch.

    Parameters
    ----------
    result : object
        A result of any kind; a study is its dataset.
    directory : str or os.PathLike
        Folder to write to; made if it does not exist.
    prefix : str
        Beginning of the file names.

    Returns
    -------
    list of Path
        The files written, each of which appears complete or not at all. For a
        solution `overview.png`, `marginals.png` and `angle.png` if a density was
        saved, `entropy.png` if there is a relative entropy, and `moments.png`. For
        paths `ensemble.png`, and if their starts were kept one path: `fibre.png`, or
        `trajectory.png` on a belt at rest. For solutions of the limits
        `hydrodynamic.png` and `law.png`, if a density was saved. docs/results.md has
        those of the other kinds.

    Raises
    ------
    TypeError, ValueError
        If it is no result of fpsolve.
    """
    figures = possible_figures(result)
    directory = made_folder(directory)
    with paper_style():
        return [
            write_figure(plot(result), directory / f"{prefix}{name}.png")
            for name, plot in figures.items()
        ]


def possible_figures(result: Any) -> dict[str, Callable[[Any], Figure]]:
    """Names of the figures that the result allows, with what draws them."""
    return FIGURES[kind_of(result)](result)


def write_figure(figure: Figure, path: Path) -> Path:
    """Write a figure as PNG, whole or not at all; return the path."""
    with paper_style(), atomic_path(path) as draft:
        figure.savefig(draft, dpi=RESOLUTION)
    return path
