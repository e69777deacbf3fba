"""`fpsolve check`: compare the density of a configuration with paths."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fpsolve.cli.command import command_line
from fpsolve.cli.console import print_lines, print_table
from fpsolve.cli.errors import FAILED
from fpsolve.cli.frame import Frame, command
from fpsolve.cli.options import (
    Config,
    Example,
    NoFigures,
    Out,
    Threads,
    read_config,
    set_threads,
)

if TYPE_CHECKING:
    from fpsolve.cli.config.run import Problem
    from fpsolve.studies.agreement.check import CrossCheck

__all__ = ["check"]

NumberOfPaths = Annotated[int, typer.Option(help="Number of paths.")]
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
    float, typer.Option(help="Probability of failing although density and paths agree.")
]
PathsStep = Annotated[
    float | None,
    typer.Option(help="Step of the paths.", show_default="from the error estimate"),
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
    with command(out) as frame:
        from fpsolve.pages.cross_check import HEADINGS, summary_row
        from fpsolve.plotting.comparison import plot_cross_check

        chosen = read_config(config, example)
        frame.figures = chosen.output.figures and not no_figures
        stem = f"{chosen.output.name}-check"
        frame.claim(*(f"{stem}.{ending}" for ending in ("json", "nc", "png")))
        set_threads(threads)
        problem = chosen.build()
        places = at if at else _places(problem)
        result = _compare(
            frame, problem, places, paths_ds,
            n_paths=n_paths, seed=seed, false_alarm=false_alarm,
        )  # fmt: skip
        print_table(HEADINGS, (summary_row(result, float(s)) for s in result.s))
        print_lines(str(result))
        used = command_line(
            "check", *([] if config is None else [config.name]), example=example,
            n_paths=n_paths, seed=seed, at=places, paths_ds=paths_ds,
            false_alarm=false_alarm,
        )  # fmt: skip
        used["configuration"] = chosen.resolved(problem).to_toml()
        numbers = json.dumps(result.to_dict(), indent=1, ensure_ascii=False)
        frame.text(numbers, f"{stem}.json")
        frame.finish(result.to_xarray().assign_attrs(used), f"{stem}.nc")
        frame.figure(plot_cross_check, result, name=f"{stem}.png")
        if not result.agrees:
            raise typer.Exit(FAILED)


def _places(problem: Problem) -> list[float]:
    """First, middle and last of the positive arclengths that a run saves."""
    saved = [s for s in problem.arguments["save_at"] if s > 0]
    if len(saved) <= _MOST_PLACES:
        return saved or [problem.arguments["s_span"][1]]
    return [saved[0], saved[len(saved) // 2], saved[-1]]


def _compare(
    frame: Frame,
    problem: Problem,
    places: list[float],
    paths_ds: float | None,
    **options: Any,
) -> CrossCheck:
    from fpsolve.grids import diagnostics
    from fpsolve.grids.smooth import SmoothPhaseSpaceGrid
    from fpsolve.studies.agreement.cross_check import cross_check

    given, start = problem.arguments, problem.p0
    if isinstance(problem.grid, SmoothPhaseSpaceGrid):
        # Paths and density both begin with the curvature of a free fibre.
        start = diagnostics.marginal(start, problem.grid, "xi_alpha")
    tolerances = {name: given[name] for name in given if name.endswith("_tolerance")}
    typer.echo(f"equation  {problem.model.equation}")
    with frame.computing() as report:
        return cross_check(
            problem.model,
            start,
            places,
            scheme=problem.scheme,
            ds=float(given["ds"]),
            paths_ds=paths_ds,
            solve_options=tolerances,
            progress=report,
            **options,
        )
