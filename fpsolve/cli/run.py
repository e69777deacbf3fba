"""`fpsolve run`: solve what a configuration describes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fpsolve.cli.frame import command
from fpsolve.cli.options import (
    Config,
    Example,
    KeepCheckpoint,
    NoFigures,
    Out,
    Threads,
    read_config,
    set_threads,
)
from fpsolve.cli.solving import solve_and_write

__all__ = ["run"]

Every = Annotated[
    str | None,
    typer.Option(
        metavar="EVERY",
        help="Write a checkpoint every so many steps, 100, or so often, 30s or 5min.",
    ),
]


def run(
    config: Config = None,
    out: Out = Path("results"),
    example: Example = None,
    no_figures: NoFigures = False,
    threads: Threads = None,
    checkpoint: Every = None,
    keep_checkpoint: KeepCheckpoint = False,
) -> None:
    """Solve what a configuration describes.

    Writes the result, the configuration used and figures, and prints a table. Ctrl-C
    stops the run and writes what was recorded until then. With `--checkpoint`, a run
    that was stopped or killed goes on by the same command or by `fpsolve resume`.
    """
    with command() as frame:
        chosen = read_config(config, example)
        chosen = chosen.changed("output", figures=False if no_figures else None)
        set_threads(threads)
        frame.use(out)
        from fpsolve.density.checkpoints.checkpoint import Checkpoint, parse_interval

        if checkpoint is not None:
            parse_interval(checkpoint)
        problem = chosen.build(saved_in_memory=checkpoint is None)
        chosen = chosen.resolved(problem)
        kept = None
        if checkpoint is not None:
            folder = frame.path(f"{chosen.output.name}.checkpoint")
            notes = {"configuration": chosen.to_toml()}
            kept = Checkpoint(folder, checkpoint, notes)
        solve_and_write(frame, problem, chosen, kept, keep_checkpoint)
