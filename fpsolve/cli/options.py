"""Options that several commands have, and what is done with them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fpsolve.cli.completion import EXAMPLES, proposing

if TYPE_CHECKING:
    from fpsolve.cli.config.run import RunConfig

__all__ = [
    "Config",
    "Example",
    "KeepCheckpoint",
    "NoFigures",
    "Out",
    "Scheduler",
    "Threads",
    "Workers",
    "read_config",
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
KeepCheckpoint = Annotated[
    bool,
    typer.Option(
        "--keep-checkpoint", help="Leave the checkpoint when the result is written."
    ),
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS",
        help="Run on the dask scheduler at this address.",
        show_default=False,
    ),
]
Workers = Annotated[
    int | None,
    typer.Option(min=0, help="Processes; 0 runs in this one.", show_default="CPUs"),
]


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
