"""The saved densities as a movie."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.checks import check_path, check_real
from fpsolve._support.files import atomic_path
from fpsolve.density.solution import Solution
from fpsolve.plotting.maps import draw_plane
from fpsolve.plotting.overview import draw_decay
from fpsolve.plotting.selection import check_solution
from fpsolve.plotting.style import COLOURS, PAGE, new_figure, paper_style, parameters

if TYPE_CHECKING:
    from matplotlib.animation import AbstractMovieWriter

__all__ = ["check_movie", "movie"]

_SUFFIXES = (".gif", ".mp4")
_RESOLUTION = 120
# A GIF counts hundredths of a second, up to 65535 of them for a frame.
_FASTEST, _SLOWEST = 100, 100 / 65535


def movie(
    solution: Solution, path: str | os.PathLike[str], *, fps: float = 8.0
) -> Path:
    """Write a movie of ∫ p dα beside the decay of H(p|p_S), a frame per saved density.

    Parameters
    ----------
    solution : Solution
        With at least two saved densities.
    path : str or os.PathLike
        Ends in ".gif" or ".mp4"; the latter needs the program ffmpeg.
    fps : float
        Frames per second.

    Returns
    -------
    Path
        The path written; the file appears complete or not at all.

    Raises
    ------
    ValueError
        If fewer than two densities were saved, the suffix is unknown, ffmpeg is
        missing, or `fps` is not positive.
    """
    path, writer = check_movie(solution, path, fps)
    with paper_style(), atomic_path(path) as draft:
        figure, show = _stage(solution)
        with writer.saving(figure, str(draft), _RESOLUTION):
            for s in solution.saved_s:
                show(float(s))
                writer.grab_frame()
    return path


def check_movie(
    solution: Solution, path: str | os.PathLike[str], fps: float
) -> tuple[Path, AbstractMovieWriter]:
    """Return the path and what writes to it; raise what `movie` does."""
    check_solution(solution)
    path = check_path("path", path)
    writer = _writer(path, fps)
    if len(solution.saved_s) < 2:
        raise ValueError(
            "`solution` must hold at least two saved densities for a movie, got "
            f"{len(solution.saved_s)}; name more arclengths in `save_at` of the run."
        )
    return path, writer


def _writer(path: Path, fps: float) -> AbstractMovieWriter:
    from matplotlib.animation import FFMpegWriter, PillowWriter

    fps = check_real("fps", fps)
    if not (np.isfinite(fps) and fps > 0):
        raise ValueError(f"`fps` must be positive, got {fps:g}.")
    if not fps <= _FASTEST:
        raise ValueError(
            f"`fps` must be at most {_FASTEST}, got {fps:g}; a GIF counts hundredths "
            "of a second."
        )
    if not fps >= _SLOWEST:
        raise ValueError(
            f"`fps` must be at least {_SLOWEST:.2g}, got {fps:g}; a frame of a GIF "
            "lasts eleven minutes at most."
        )
    if path.suffix not in _SUFFIXES:
        known = " or ".join(_SUFFIXES)
        raise ValueError(f"`path` of a movie must end in {known}, got `{path.name}`.")
    if path.suffix == ".gif":
        return PillowWriter(fps=fps)  # type: ignore[arg-type]
    if not FFMpegWriter.isAvailable():
        raise ValueError(
            f"`path` must end in .gif where ffmpeg is not installed, got `{path.name}`."
        )
    return FFMpegWriter(fps=fps)  # type: ignore[arg-type]


def _stage(solution: Solution) -> tuple[Any, Any]:
    """Return the figure of the first frame and the function that shows another."""
    figure = new_figure(PAGE, 3.0)
    left, right = figure.subplots(1, 2)
    maps = {float(s): solution.marginal("xi", s) for s in solution.saved_s}
    image = draw_plane(left, solution.grid, solution.model, list(maps.values()))
    draw_decay(right, solution, "spread")
    first = float(solution.saved_s[0])
    cursor = right.axvline(first, color=COLOURS["vermilion"], linewidth=1.0)
    figure.suptitle(parameters(solution))

    def show(s: float) -> None:
        image.set_data(maps[s].T)
        left.set_title(f"$s = {s:.4g}$")
        cursor.set_xdata([s, s])

    return figure, show
