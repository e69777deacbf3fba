"""All figures of a solution, or of paths, as PNG files."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fpsolve.io.atomic import atomic_path, made_folder
from fpsolve.paths import Paths
from fpsolve.plotting.angle import plot_angle
from fpsolve.plotting.ensembles import plot_ensemble
from fpsolve.plotting.entropy import has_entropy, plot_entropy
from fpsolve.plotting.marginals import plot_marginals
from fpsolve.plotting.moments import plot_moments
from fpsolve.plotting.overview import plot_overview
from fpsolve.plotting.selection import check_solution
from fpsolve.plotting.style import RESOLUTION, paper_style
from fpsolve.plotting.trajectories import plot_fibre, plot_trajectories
from fpsolve.solution import Solution

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["possible_figures", "save_figures"]


def save_figures(
    result: Solution | Paths, directory: str | os.PathLike[str], *, prefix: str = ""
) -> list[Path]:
    """Write every figure that the result allows as a PNG of 200 dots per inch.

    Parameters
    ----------
    result : Solution or Paths
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
        `trajectory.png` on a belt at rest.
    """
    if not isinstance(result, Paths):
        check_solution(result)
    directory = made_folder(directory)
    with paper_style():
        return [
            _write(plot(result), directory / f"{prefix}{name}.png")
            for name, plot in possible_figures(result).items()
        ]


def possible_figures(result: Solution | Paths) -> dict[str, Callable[[Any], Figure]]:
    """Names of the figures that the result allows, with what draws them."""
    if isinstance(result, Paths):
        return _figures_of_paths(result)
    return _figures_of_solution(result)


def _figures_of_paths(paths: Paths) -> dict[str, Callable[[Any], Figure]]:
    figures: dict[str, Callable[[Any], Figure]] = {"ensemble": plot_ensemble}
    # Without its model or its start no path can be run again.
    if paths.model is None or not (paths.kept or paths.initial is not None):
        return figures
    if paths.model.curve.fixed:
        return {**figures, "trajectory": plot_trajectories}
    return {**figures, "fibre": plot_fibre}


def _figures_of_solution(solution: Solution) -> dict[str, Callable[[Any], Figure]]:
    figures: dict[str, Callable[[Any], Figure]] = {}
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
