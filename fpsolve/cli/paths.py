"""`fpsolve paths`: sample the paths that a configuration asks for."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fpsolve.cli.frame import Frame, command
from fpsolve.cli.options import NoFigures, Out, Threads, set_threads
from fpsolve.cli.writing import claim_result, print_moments, write_result

if TYPE_CHECKING:
    from fpsolve.cli.config.paths import PathsConfig

__all__ = ["paths"]

Config = Annotated[
    Path | None,
    typer.Argument(
        metavar="CONFIG.toml",
        help="TOML file with a section [paths]; without it the packaged example.",
    ),
]
NumberOfPaths = Annotated[
    int | None, typer.Option(min=1, help="Number of paths.", show_default="of the file")
]
Seed = Annotated[
    int | None,
    typer.Option(min=0, help="Seed of the random numbers.", show_default="of the file"),
]


def paths(
    config: Config = None,
    out: Out = Path("results"),
    n_paths: NumberOfPaths = None,
    seed: Seed = None,
    no_figures: NoFigures = False,
    threads: Threads = None,
) -> None:
    """Sample paths of the process that a configuration describes.

    Writes the paths, the configuration used and figures, and prints moments with
    their standard errors. Path k is the same whatever the number of paths. Ctrl-C
    stops the sampling and writes what was finished until then.
    """
    with command(out) as frame:
        from fpsolve.cli.config.paths import PathsConfig
        from fpsolve.cli.config.reading import PATHS_EXAMPLE, example_path, load_config

        path = example_path(PATHS_EXAMPLE) if config is None else config
        chosen = load_config(path, PathsConfig)
        seed_from = "from the configuration" if seed is None else "from `--seed`"
        if seed is None and chosen.paths.seed is None:
            seed_from = "drawn"
        chosen = chosen.changed("paths", n_paths=n_paths, seed=seed)
        chosen = chosen.changed("output", figures=False if no_figures else None)
        set_threads(threads)
        _sample(frame, chosen, seed_from)


def _sample(frame: Frame, config: PathsConfig, seed_from: str) -> None:
    from fpsolve.cli.plan import print_paths_plan
    from fpsolve.paths.sampling import sample_paths

    problem = config.build()
    config = config.resolved(problem)
    name = config.output.file_name
    frame.figures = config.output.figures
    claim_result(frame, name)
    print_paths_plan(config, problem, frame.out, seed_from)
    write = partial(
        write_result,
        frame=frame,
        file_name=name,
        show=print_moments,
        toml=config.to_toml(),
    )
    kept = "what was finished until then is kept"
    with frame.computing(keep=write, kept=kept) as report:
        sampled = sample_paths(problem.model, **problem.arguments, progress=report)
    write(sampled)
