"""`fpsolve run`: solve what a configuration describes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fpsolve.cli.completion import EXAMPLES, proposing
from fpsolve.cli.errors import reported_errors
from fpsolve.cli.solving import solve_and_write

if TYPE_CHECKING:
    from fpsolve.cli.config.run import RunConfig
    from fpsolve.density.checkpoints.checkpoint import Checkpoint

__all__ = [
    "KeepCheckpoint",
    "NoFigures",
    "Threads",
    "read_config",
    "run",
    "set_threads",
]

Config = Annotated[
    Path | None,
    typer.Argument(
        metavar="CONFIG.toml",
        help="TOML file that describes the run; without it the packaged example.",
        show_default=False,
    ),
]
Out = Annotated[Path, typer.Option(help="Folder for the result and the figures.")]
Example = Annotated[
    str | None,
    typer.Option(
        metavar="NAME",
        help="Run a packaged example: laydown or spunbond.",
        autocompletion=proposing(*EXAMPLES),
        show_default=False,
    ),
]
NoFigures = Annotated[bool, typer.Option("--no-figures", help="Draw no figures.")]
Threads = Annotated[
    int | None,
    typer.Option(min=1, help="Threads for the kernels.", show_default="all"),
]
Every = Annotated[
    str | None,
    typer.Option(
        metavar="EVERY",
        help="Write a checkpoint every so many steps, 100, or so often, 30s or 5min.",
        show_default=False,
    ),
]
KeepCheckpoint = Annotated[
    bool,
    typer.Option(
        "--keep-checkpoint", help="Leave the checkpoint when the result is written."
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
    with reported_errors():
        chosen = read_config(config, example)
        if no_figures:
            chosen = chosen.without_figures()
        set_threads(threads)
        _solve(chosen, out, checkpoint, keep_checkpoint)


def read_config(config: Path | None, example: str | None) -> RunConfig:
    """Return what a file or a packaged example describes."""
    from fpsolve.cli.config.examples import EXAMPLES, example_path
    from fpsolve.cli.config.reading import load_config

    if config is not None and example is not None:
        raise ValueError(
            f"`--example` must not be given beside a file, got {example!r} and "
            f"`{config}`; leave one out."
        )
    if config is not None:
        return load_config(config)
    return load_config(example_path(EXAMPLES[0] if example is None else example))


def set_threads(threads: int | None) -> None:
    """Limit the kernels to that many threads."""
    if threads is None:
        return
    import numba

    # As long as nothing was set, numba uses as many as it can.
    most = numba.get_num_threads()
    if threads > most:
        raise ValueError(
            f"`--threads` must be at most {most} on this machine, got {threads}; "
            "NUMBA_NUM_THREADS sets the limit."
        )
    numba.set_num_threads(threads)


def _solve(config: RunConfig, out: Path, every: str | None, keep: bool) -> None:
    from fpsolve._support.files import check_folder, made_folder
    from fpsolve.density.checkpoints.every import parse_interval

    check_folder(out, "--out")
    if every is not None:
        parse_interval(every)
    problem = config.build(saved_in_memory=every is None)
    config = config.resolved(problem)
    if every is not None:
        made_folder(out, "--out")
    checkpoint = None if every is None else _checkpoint(config, out, every)
    solve_and_write(problem, config, out, checkpoint, keep)


def _checkpoint(config: RunConfig, out: Path, every: str) -> Checkpoint:
    from fpsolve.density.checkpoints.checkpoint import Checkpoint

    folder = out / f"{config.output.name}.checkpoint"
    return Checkpoint(folder, every, {"configuration": config.to_toml()})
