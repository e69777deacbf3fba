"""What is printed about sampled paths: the plan before, the moments after."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from fpsolve.cli.console import print_lines, print_pairs, print_table
from fpsolve.cli.plan import units_text, with_options

if TYPE_CHECKING:
    from fpsolve.cli.config.paths import PathsConfig, PathsProblem
    from fpsolve.paths.result import Paths

__all__ = ["print_moments", "print_paths_plan"]


def print_paths_plan(
    config: PathsConfig, problem: PathsProblem, out: Path, seed_from: str
) -> None:
    """Print equation, units, start, steps, method, and where the seed comes from."""
    print_pairs(_plan(config, problem, out, seed_from))


def _plan(
    config: PathsConfig, problem: PathsProblem, out: Path, seed_from: str
) -> list[tuple[str, str]]:
    arguments = problem.arguments
    lines = [("equation", problem.model.process_equation)]
    if config.process is not None:
        lines.append(("units", units_text(config.process.make())))
    start = "ξ = 0, α uniform" if config.start is None else with_options(config.start)
    lines += [("start", start), ("paths", _steps(arguments))]
    lines += [
        ("method", arguments["method"]),
        ("seed", f"{arguments['seed']} ({seed_from})"),
    ]
    if config.histogram is not None:
        lines.append(("histogram", _cells(arguments["histogram"])))
    return [*lines, ("result", str(out / config.output.file_name))]


def _steps(arguments: dict[str, Any]) -> str:
    end, ds = arguments["s_end"], arguments["ds"]
    kept = "" if arguments["keep"] else ", positions not kept"
    return (
        f"{arguments['n_paths']} of length {end:g}, ds = {ds:g}, saved at "
        f"{len(arguments['save_at'])} arclengths{kept}"
    )


def _cells(grid: Any) -> str:
    width1, width2 = grid.half_widths
    shape = " x ".join(map(str, grid.shape))
    return f"{shape} cells, |ξ₁| < {width1:g}, |ξ₂| < {width2:g}"


def print_moments(paths: Paths) -> None:
    """Print means and variances with their standard errors at some arclengths."""
    from fpsolve.pages.paths import MOMENTS, moment_rows

    print_table(("s", *MOMENTS), moment_rows(paths))
    print_lines(
        "in parentheses: one standard error, in units of the last digit", _speed(paths)
    )


def _speed(paths: Paths) -> str:
    wall, cpu = (paths.provenance[f"{clock}_seconds"] for clock in ("wall", "cpu"))
    return f"{paths.status} after {wall:.2f} s ({cpu:.2f} s of CPU time)"
