"""`fpsolve run`: solve what a configuration describes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fpsolve.cli.errors import FAILED, INTERRUPTED, fail, reported_errors

if TYPE_CHECKING:
    from fpsolve.config import Problem, RunConfig
    from fpsolve.solution import Solution

__all__ = ["read_config", "run", "set_threads"]

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
        show_default=False,
    ),
]
NoFigures = Annotated[bool, typer.Option("--no-figures", help="Draw no figures.")]
Threads = Annotated[
    int | None,
    typer.Option(min=1, help="Threads for the kernels.", show_default="all"),
]


def run(
    config: Config = None,
    out: Out = Path("results"),
    example: Example = None,
    no_figures: NoFigures = False,
    threads: Threads = None,
) -> None:
    """Solve what a configuration describes.

    Writes the result, the configuration used and figures, and prints a table. Ctrl-C
    stops the run and writes what was recorded until then.
    """
    with reported_errors():
        chosen = read_config(config, example)
        if no_figures:
            output = chosen.output.model_copy(update={"figures": False})
            chosen = chosen.model_copy(update={"output": output})
        set_threads(threads)
        _solve(chosen, out)


def read_config(config: Path | None, example: str | None) -> RunConfig:
    """Return what a file or a packaged example describes."""
    from fpsolve.config import EXAMPLES, example_path, load_config

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


def _solve(config: RunConfig, out: Path) -> None:
    from fpsolve.cli.plan import print_plan
    from fpsolve.errors import RunError, RunInterrupted
    from fpsolve.io.files import check_engine

    check_engine("zarr" if config.output.format == "zarr" else "h5netcdf")
    out.mkdir(parents=True, exist_ok=True)
    problem = config.build()
    config = config.resolved(problem)
    print_plan(config, problem, out)
    try:
        solution = _evolve(problem)
    except RunInterrupted as interrupt:
        _write(interrupt.solution, config, out, figures=False)
        fail("interrupted; what was recorded until then is kept", INTERRUPTED)
    except RunError as error:
        if error.solution is not None:
            _write(error.solution, config, out, figures=False)
        fail(error, FAILED)
    _write(solution, config, out, figures=config.output.figures)


def _evolve(problem: Problem) -> Solution:
    # Not `from fpsolve.solve import solve`: a test replaces the bar in its module.
    from fpsolve.cli import progress
    from fpsolve.solve import solve

    with progress.progress_bar() as report:
        return solve(problem.scheme, problem.p0, **problem.arguments, progress=report)


def _write(solution: Solution, config: RunConfig, out: Path, figures: bool) -> None:
    from fpsolve.cli.report import print_report
    from fpsolve.cli.writing import write_result

    write_result(solution, config, out, figures=figures, show=print_report)
