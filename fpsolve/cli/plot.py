"""`fpsolve plot`: draw a stored result."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fpsolve.cli.errors import reported_errors

__all__ = ["plot"]

File = Annotated[
    Path,
    typer.Argument(metavar="FILE", help="Result of `fpsolve run` or of Solution.save."),
]
Out = Annotated[
    Path | None,
    typer.Option(
        help="Folder for the figures; by default that of the file.",
        show_default=False,
    ),
]
Movie = Annotated[bool, typer.Option("--movie", help="Also make a movie (GIF).")]
FramesPerSecond = Annotated[float, typer.Option(help="Frames per second of the movie.")]


def plot(
    file: File, out: Out = None, movie: Movie = False, fps: FramesPerSecond = 8.0
) -> None:
    """Draw the figures of a result, or a movie."""
    with reported_errors():
        from fpsolve import plotting
        from fpsolve.io import load

        solution = load(file)
        folder = file.parent if out is None else out
        for path in plotting.save_figures(solution, folder, prefix=f"{file.stem}-"):
            typer.echo(path)
        if movie:
            path = folder / f"{file.stem}.gif"
            typer.echo(plotting.movie(solution, path, fps=fps))
