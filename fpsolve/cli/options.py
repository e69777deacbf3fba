"""Options that several commands have, what completes them and is done with them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from fpsolve.cli.config.run import RunConfig

__all__ = [
    "CONFINING",
    "EXAMPLES",
    "EXPORTS",
    "METHODS",
    "MODELS",
    "MOTIONS",
    "PARTS",
    "PHASES",
    "POSITIONS",
    "UNITS",
    "Config",
    "Example",
    "KeepCheckpoint",
    "NoFigures",
    "Out",
    "Scheduler",
    "Threads",
    "Workers",
    "proposing",
    "read_config",
    "set_threads",
]

# Written out, because a shell waits for the answer: the modules that know these words
# take half a second to import. tests/cli/test_cli_completion.py holds them together.
EXAMPLES = ("laydown", "spunbond")
CONFINING = ("quadratic", "linear", "power")
PARTS = ("relaxation", "evolution", "branches", "gap", "variance")
POSITIONS = ("regular", "random")
PHASES = ("independent", "in phase")
EXPORTS = ("png", "tiff", "vtp", "csv")
MODELS = ("smooth", "basic")
METHODS = ("likelihood", "functional")
MOTIONS = ("rotating", "oscillating")
# Of lengths in a table, in metres.
UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}


def proposing(*words: str) -> Callable[[str], list[str]]:
    """Return what completes the beginning of one of the words."""

    def completions(incomplete: str) -> list[str]:
        return [word for word in words if word.startswith(incomplete)]

    return completions


Config = Annotated[
    Path | None,
    typer.Argument(
        metavar="CONFIG.toml",
        help="TOML file that describes the run; without it the packaged example.",
    ),
]
Out = Annotated[Path, typer.Option(help="Folder for the result and the figures.")]
Example = Annotated[
    str | None,
    typer.Option(
        metavar="NAME",
        help="Run a packaged example: laydown or spunbond.",
        autocompletion=proposing(*EXAMPLES),
    ),
]
NoFigures = Annotated[bool, typer.Option("--no-figures", help="Draw no figures.")]
Threads = Annotated[
    int | None, typer.Option(min=1, help="Threads for the kernels.", show_default="all")
]
KeepCheckpoint = Annotated[
    bool,
    typer.Option(
        "--keep-checkpoint", help="Leave the checkpoint when the result is written."
    ),
]
Scheduler = Annotated[
    str | None,
    typer.Option(metavar="ADDRESS", help="Run on the dask scheduler at this address."),
]
Workers = Annotated[
    int | None,
    typer.Option(min=0, help="Processes; 0 runs in this one.", show_default="CPUs"),
]


def read_config(config: Path | None, example: str | None) -> RunConfig:
    """Return what a file or a packaged example describes."""
    from fpsolve.cli.config.reading import example_path, load_config

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
