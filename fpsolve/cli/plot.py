"""`fpsolve plot`: draw a stored result."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fpsolve.cli.frame import command

__all__ = ["plot"]

File = Annotated[
    Path,
    typer.Argument(
        metavar="FILE", help="Result of `fpsolve run`, `fpsolve paths`, or of `save`."
    ),
]
Out = Annotated[
    Path | None,
    typer.Option(help="Folder for the figures; by default that of the file."),
]
Movie = Annotated[
    bool, typer.Option("--movie", help="Also make a movie (GIF) of a density.")
]
FramesPerSecond = Annotated[float, typer.Option(help="Frames per second of the movie.")]


def plot(
    file: File, out: Out = None, movie: Movie = False, fps: FramesPerSecond = 8.0
) -> None:
    """Draw the figures of a result, or a movie."""
    with command(out):
        from fpsolve import plotting
        from fpsolve.density.solution import Solution
        from fpsolve.plotting.movie import check_movie
        from fpsolve.results import load
        from fpsolve.results.kinds import KINDS, kind_of

        result = load(file)
        if movie and not isinstance(result, Solution):
            raise ValueError(
                "`--movie` must be given with the result of `fpsolve run`, got "
                f"{KINDS[kind_of(result)].words} in `{file}`; leave it out."
            )
        folder = file.parent if out is None else out
        if movie:
            # A figure already written would be all that is left of the mistake.
            check_movie(result, folder / f"{file.stem}.gif", fps)
        for path in plotting.save_figures(result, folder, prefix=f"{file.stem}-"):
            typer.echo(path)
        if movie and isinstance(result, Solution):
            path = folder / f"{file.stem}.gif"
            typer.echo(plotting.movie(result, path, fps=fps))
