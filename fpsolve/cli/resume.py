"""`fpsolve resume`: complete the run whose checkpoint is in a folder."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fpsolve.cli.frame import Frame, command
from fpsolve.cli.options import KeepCheckpoint, NoFigures, Threads, set_threads
from fpsolve.cli.solving import RECORDED, say_where, solve_and_write
from fpsolve.cli.writing import claim_result, print_solution, write_result

if TYPE_CHECKING:
    from fpsolve.density.checkpoints.manifest import Manifest

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
    with command(figures=not no_figures) as frame:
        from fpsolve.density.checkpoints.manifest import read_manifest

        manifest = read_manifest(directory)
        set_threads(threads)
        # "." has no name, nor has a path that ends in "..".
        home = directory if directory.name else directory.resolve()
        frame.use(home.parent if out is None else out)
        if "configuration" in manifest.notes:
            _resume_configured(frame, directory, manifest, keep_checkpoint)
        else:
            _resume_other(frame, directory)


def _resume_configured(
    frame: Frame, directory: Path, manifest: Manifest, keep: bool
) -> None:
    """Go on with what `fpsolve run` began."""
    from fpsolve.cli.config.reading import read_config
    from fpsolve.density.checkpoints.checkpoint import Checkpoint
    from fpsolve.density.checkpoints.start import read_start

    text = manifest.notes["configuration"]
    config = read_config(text, f"the configuration in `{directory}`")
    config = config.changed("output", figures=None if frame.figures else False)
    p0 = read_start(directory, manifest.run)["p0"]
    problem = config.build(saved_in_memory=False)._replace(p0=p0)
    checkpoint = Checkpoint(directory, manifest.every, manifest.notes)
    solve_and_write(frame, problem, config, checkpoint, keep)


def _resume_other(frame: Frame, directory: Path) -> None:
    """Go on with what Python began; the folder stays, for Python may still use it."""
    from fpsolve.density.resume import resume as completed

    name = f"{directory.absolute().stem}.nc"
    claim_result(frame, name)
    say_where(directory)
    write = partial(write_result, frame=frame, file_name=name, show=print_solution)
    with frame.computing(keep=write, kept=RECORDED) as report:
        solution = completed(directory, progress=report)
    write(solution)
