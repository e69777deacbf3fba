"""`fpsolve resume`: complete the run whose checkpoint is in a folder."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fpsolve.cli.errors import reported_errors
from fpsolve.cli.run import KeepCheckpoint, NoFigures, Threads, set_threads
from fpsolve.cli.solving import keeping_partial_results, say_where, solve_and_write

if TYPE_CHECKING:
    from fpsolve.density.checkpoints.manifest import Manifest
    from fpsolve.density.solution import Solution

__all__ = ["resume"]

Directory = Annotated[
    Path,
    typer.Argument(metavar="DIR", help="Folder of the checkpoint.", show_default=False),
]
Out = Annotated[
    Path | None,
    typer.Option(
        help="Folder for the result and the figures.", show_default="that of DIR"
    ),
]


def resume(
    directory: Directory,
    out: Out = None,
    no_figures: NoFigures = False,
    keep_checkpoint: KeepCheckpoint = False,
    threads: Threads = None,
) -> None:
    """Complete a run that was stopped or killed, from its checkpoint.

    The result is bitwise that of a run that was never stopped, and it is written,
    drawn and shown in the same way.
    """
    with reported_errors():
        from fpsolve._support.files import check_folder
        from fpsolve.density.checkpoints.manifest import read_manifest

        manifest = read_manifest(directory)
        set_threads(threads)
        # "." has no name, nor has a path that ends in "..".
        home = directory if directory.name else directory.resolve()
        out = check_folder(home.parent if out is None else out, "--out")
        if "configuration" in manifest.notes:
            _resume_configured(directory, manifest, out, no_figures, keep_checkpoint)
        else:
            _resume_other(directory, out, not no_figures)


def _resume_configured(
    directory: Path, manifest: Manifest, out: Path, no_figures: bool, keep: bool
) -> None:
    """Go on with what `fpsolve run` began."""
    from fpsolve.cli.config.reading import read_config
    from fpsolve.density.checkpoints.checkpoint import Checkpoint
    from fpsolve.density.checkpoints.start import read_start

    text = manifest.notes["configuration"]
    config = read_config(text, f"the configuration in `{directory}`")
    if no_figures:
        config = config.without_figures()
    p0, _ = read_start(directory, manifest.run)
    problem = config.build(saved_in_memory=False)._replace(p0=p0)
    checkpoint = Checkpoint(directory, manifest.every, manifest.notes)
    solve_and_write(problem, config, out, checkpoint, keep)


def _resume_other(directory: Path, out: Path, figures: bool) -> None:
    """Go on with what Python began; the folder stays, for Python may still use it."""
    from fpsolve.cli import progress
    from fpsolve.density.resume import resume as completed

    def write(solution: Solution, figures: bool) -> None:
        _write(solution, out, directory.absolute().stem, figures)

    say_where(directory)
    with keeping_partial_results(write), progress.progress_bar() as report:
        solution = completed(directory, progress=report)
    write(solution, figures)


def _write(solution: Solution, out: Path, name: str, figures: bool) -> None:
    from fpsolve._support.files import made_folder
    from fpsolve.cli.solution_table import print_solution

    made_folder(out, "--out")
    print_solution(solution)
    ending = "" if solution.status == "finished" else f"-{solution.status}"
    typer.echo(solution.save(out / f"{name}{ending}.nc"))
    if figures:
        from fpsolve.plotting.files import save_figures

        for figure in save_figures(solution, out, prefix=f"{name}-"):
            typer.echo(figure)
