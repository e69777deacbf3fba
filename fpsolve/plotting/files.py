"""All figures of a result as PNG files."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fpsolve._support.checks import shown
from fpsolve._support.files import atomic_path, made_folder
from fpsolve.density.solution import Solution
from fpsolve.paths.result import Paths
from fpsolve.plotting.angle import plot_angle
from fpsolve.plotting.ensembles import plot_ensemble
from fpsolve.plotting.entropy import has_entropy, plot_entropy
from fpsolve.plotting.marginals import plot_marginals
from fpsolve.plotting.moments import plot_moments
from fpsolve.plotting.overview import plot_overview
from fpsolve.plotting.style import RESOLUTION, paper_style
from fpsolve.plotting.trajectories import plot_fibre, plot_trajectories

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    Figures = dict[str, Callable[[Any], Figure]]

__all__ = ["possible_figures", "save_figures"]


def save_figures(
    result: Any, directory: str | os.PathLike[str], *, prefix: str = ""
) -> list[Path]:
    """Write every figure that the result allows as a PNG of 200 dots per inch.

    Parameters
    ----------
    result : Solution, Paths, HydrodynamicSolution or EnergySolution
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
        `hydrodynamic.png` and `law.png`, if a density was saved.

    Raises
    ------
    TypeError
        If it is none of these results.
    """
    kind = _kind_of(result)
    directory = made_folder(directory)
    with paper_style():
        return [
            _write(plot(result), directory / f"{prefix}{name}.png")
            for name, plot in _FIGURES[kind](result).items()
        ]


def possible_figures(result: Any) -> Figures:
    """Names of the figures that the result allows, with what draws them."""
    return _FIGURES[_kind_of(result)](result)


def _kind_of(result: Any) -> str:
    from fpsolve.results.kinds import kind_of

    try:
        return kind_of(result)
    except TypeError:
        raise TypeError(
            "`result` must be a Solution, Paths, a HydrodynamicSolution or an "
            f"EnergySolution, got {shown(result)}; figures of a study are drawn by the "
            "functions of fpsolve.plotting."
        ) from None


def _figures_of_hydrodynamic(solution: Any) -> Figures:
    from fpsolve.plotting.hydrodynamic import plot_hydrodynamic

    return {"hydrodynamic": plot_hydrodynamic} if len(solution.saved_s) else {}


def _figures_of_energy(solution: Any) -> Figures:
    from fpsolve.plotting.energy import plot_energy_law

    return {"law": plot_energy_law} if len(solution.saved_s) else {}


def _figures_of_paths(paths: Paths) -> Figures:
    figures: Figures = {"ensemble": plot_ensemble}
    # Without its model or its start no path can be run again.
    if paths.model is None or not (paths.kept or paths.initial is not None):
        return figures
    if paths.model.curve.fixed:
        return {**figures, "trajectory": plot_trajectories}
    return {**figures, "fibre": plot_fibre}


def _figures_of_solution(solution: Solution) -> Figures:
    figures: Figures = {}
    if len(solution.saved_s):
        figures["overview"] = plot_overview
        figures["marginals"] = plot_marginals
        figures["angle"] = plot_angle
    if has_entropy(solution):
        figures["entropy"] = plot_entropy
    if len(solution.series["s"]):
        figures["moments"] = plot_moments
    return figures


_FIGURES: dict[str, Callable[[Any], Figures]] = {
    "solution": _figures_of_solution,
    "paths": _figures_of_paths,
    "hydrodynamic": _figures_of_hydrodynamic,
    "energy": _figures_of_energy,
}


def _write(figure: Figure, path: Path) -> Path:
    with paper_style(), atomic_path(path) as draft:
        figure.savefig(draft, dpi=RESOLUTION)
    return path
