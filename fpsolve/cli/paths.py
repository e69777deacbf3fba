"""`fpsolve paths`: sample the paths that a configuration asks for."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fpsolve.cli.errors import FAILED, INTERRUPTED, fail, reported_errors
from fpsolve.cli.run import NoFigures, Out, Threads

if TYPE_CHECKING:
    from fpsolve.cli.config.paths import PathsConfig
    from fpsolve.paths.result import Paths

__all__ = ["paths"]

Config = Annotated[
    Path | None,
    typer.Argument(
        metavar="CONFIG.toml",
        help="TOML file with a section [paths]; without it the packaged example.",
        show_default=False,
    ),
]
NumberOfPaths = Annotated[
    int | None,
    typer.Option(
        "--n-paths", min=1, help="Number of paths.", show_default="of the file"
    ),
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
    with reported_errors():
        from fpsolve._support.files import check_folder

        check_folder(out, "--out")
        from fpsolve.cli.run import set_threads

        chosen = _read(config)
        seed_from = "from the configuration" if seed is None else "from `--seed`"
        if seed is None and chosen.paths.seed is None:
            seed_from = "drawn"
        chosen = _changed(chosen, "paths", n_paths=n_paths, seed=seed)
        chosen = _changed(chosen, "output", figures=False if no_figures else None)
        set_threads(threads)
        _sample(chosen, out, seed_from)


def _read(config: Path | None) -> PathsConfig:
    from fpsolve.cli.config.examples import PATHS_EXAMPLE, example_path
    from fpsolve.cli.config.paths import PathsConfig
    from fpsolve.cli.config.reading import load_config

    path = example_path(PATHS_EXAMPLE) if config is None else config
    return load_config(path, PathsConfig)


def _changed(config: PathsConfig, section: str, **keys: Any) -> PathsConfig:
    """Return the configuration with the keys that are not None in a section."""
    given = {name: value for name, value in keys.items() if value is not None}
    changed = getattr(config, section).model_copy(update=given)
    return config.model_copy(update={section: changed})


def _sample(config: PathsConfig, out: Path, seed_from: str) -> None:
    # Not `from fpsolve.cli.progress import`: a test replaces the bar in its module.
    from fpsolve.cli import progress
    from fpsolve.cli.ensemble import print_paths_plan
    from fpsolve.cli.writing import check_result
    from fpsolve.errors import RunError, RunInterrupted
    from fpsolve.paths.sampling import sample_paths

    problem = config.build()
    config = config.resolved(problem)
    check_result(config, out)
    print_paths_plan(config, problem, out, seed_from)
    try:
        with progress.progress_bar() as report:
            sampled = sample_paths(problem.model, **problem.arguments, progress=report)
    except RunInterrupted as interrupt:
        _write_part(interrupt.solution, config, out)
        fail("interrupted; what was finished until then is kept", INTERRUPTED)
    except RunError as error:
        _write_part(error.solution, config, out)
        fail(error, FAILED)
    _write(sampled, config, out, figures=config.output.figures)


def _write_part(sampled: Paths | None, config: PathsConfig, out: Path) -> None:
    if sampled is not None:
        _write(sampled, config, out, figures=False)


def _write(sampled: Paths, config: PathsConfig, out: Path, figures: bool) -> None:
    from fpsolve.cli.ensemble import print_moments
    from fpsolve.cli.writing import write_result

    write_result(sampled, config, out, figures=figures, show=print_moments)
