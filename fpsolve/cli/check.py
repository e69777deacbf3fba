"""`fpsolve check`: compare the density of a configuration with paths."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fpsolve.cli.command import command_line
from fpsolve.cli.errors import FAILED, reported_errors
from fpsolve.cli.run import Config, Example, NoFigures, Out, Threads

if TYPE_CHECKING:
    from fpsolve.cli.config.run import Problem
    from fpsolve.studies.agreement.check import CrossCheck

__all__ = ["check"]

NumberOfPaths = Annotated[int, typer.Option("--n-paths", help="Number of paths.")]
Seed = Annotated[int, typer.Option(min=0, help="Seed of the paths.")]
At = Annotated[
    list[float] | None,
    typer.Option(
        metavar="S",
        help="Arclength at which to compare; may be given several times.",
        show_default="three of those that the file saves",
    ),
]
FalseAlarm = Annotated[
    float,
    typer.Option(help="Probability of failing although density and paths agree."),
]
PathsStep = Annotated[
    float | None,
    typer.Option(
        "--paths-ds", help="Step of the paths.", show_default="from the error estimate"
    ),
]
_MOST_PLACES = 3


def check(
    config: Config = None,
    out: Out = Path("results"),
    example: Example = None,
    n_paths: NumberOfPaths = 1_000_000,
    seed: Seed = 1,
    at: At = None,
    paths_ds: PathsStep = None,
    false_alarm: FalseAlarm = 1e-3,
    no_figures: NoFigures = False,
    threads: Threads = None,
) -> None:
    """Compare the density of a configuration with paths of the same process.

    Solves for the density, samples paths from the same start, tests at several s
    whether both have the same law, and says how large a difference would have been
    seen. Writes the numbers and a figure. The exit code is 1 if they disagree.
    """
    with reported_errors():
        from fpsolve._support.files import check_folder

        check_folder(out, "--out")
        from fpsolve.cli.run import read_config, set_threads
        from fpsolve.cli.writing import check_outputs

        chosen = read_config(config, example)
        stem = f"{chosen.output.name}-check"
        check_outputs(out, *(f"{stem}.{ending}" for ending in ("json", "nc", "png")))
        set_threads(threads)
        problem = chosen.build()
        places = at if at else _places(problem)
        result = _compare(
            problem, places, paths_ds,
            n_paths=n_paths, seed=seed, false_alarm=false_alarm,
        )  # fmt: skip
        print_check(result)
        used = command_line(
            "check", *([] if config is None else [config.name]), example=example,
            n_paths=n_paths, seed=seed, at=places, paths_ds=paths_ds,
            false_alarm=false_alarm,
        )  # fmt: skip
        used["configuration"] = chosen.resolved(problem).to_toml()
        figures = chosen.output.figures and not no_figures
        _write(result, chosen.output.name, out, used, figures=figures)
        if not result.agrees:
            raise typer.Exit(FAILED)


def print_check(check: CrossCheck) -> None:
    """Print a table with one row for every s, then the verdict in words."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    from fpsolve.pages.cross_check import HEADINGS, summary_row

    console = Console(highlight=False, markup=False)
    table = Table(box=box.SIMPLE_HEAD)
    for name in HEADINGS:
        table.add_column(name, justify="right")
    for s in check.s:
        table.add_row(*summary_row(check, float(s)))
    console.print(table)
    console.print(str(check))


def _places(problem: Problem) -> list[float]:
    """First, middle and last of the positive arclengths that a run saves."""
    saved = [s for s in problem.arguments["save_at"] if s > 0]
    if len(saved) <= _MOST_PLACES:
        return saved or [problem.arguments["s_span"][1]]
    return [saved[0], saved[len(saved) // 2], saved[-1]]


def _compare(
    problem: Problem, places: list[float], paths_ds: float | None, **options: Any
) -> CrossCheck:
    # Not `from fpsolve.cli.progress import`: a test replaces the bar in its module.
    from fpsolve.cli import progress
    from fpsolve.studies.agreement.cross_check import cross_check

    tolerances = {
        name: value
        for name, value in problem.arguments.items()
        if name.endswith("_tolerance")
    }
    typer.echo(f"equation  {problem.model.equation}")
    with progress.progress_bar() as report:
        return cross_check(
            problem.model,
            problem.p0,
            places,
            scheme=problem.scheme,
            ds=float(problem.arguments["ds"]),
            paths_ds=paths_ds,
            solve_options=tolerances,
            progress=report,
            **options,
        )


def _write(
    check: CrossCheck, name: str, out: Path, used: dict[str, str], figures: bool
) -> None:
    """Write verdict and tests as JSON, all numbers as netCDF, and the figure."""
    from fpsolve._support.files import atomic_path, made_folder
    from fpsolve._support.netcdf import write_dataset

    made_folder(out, "--out")
    stem = f"{name}-check"
    numbers = out / f"{stem}.json"
    with atomic_path(numbers) as draft:
        text = json.dumps(check.to_dict(), indent=1, ensure_ascii=False)
        draft.write_text(text, encoding="utf-8")
    typer.echo(numbers)
    dataset = check.to_xarray().assign_attrs(used)
    typer.echo(write_dataset(dataset, out / f"{stem}.nc"))
    if figures:
        typer.echo(_draw(check, out / f"{stem}.png"))


def _draw(check: CrossCheck, path: Path) -> Path:
    from fpsolve._support.files import atomic_path
    from fpsolve.plotting.comparison import plot_cross_check
    from fpsolve.plotting.style import RESOLUTION, paper_style

    with paper_style(), atomic_path(path) as draft:
        plot_cross_check(check).savefig(draft, dpi=RESOLUTION)
    return path
