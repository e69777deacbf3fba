"""What `run`, `paths`, `web` … leave: numbers, a result, its TOML, and figures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from fpsolve.cli.console import print_lines, print_table

if TYPE_CHECKING:
    from fpsolve.cli.frame import Frame
    from fpsolve.density.solution import Solution
    from fpsolve.paths.result import Paths
    from fpsolve.web.web import Web

__all__ = ["claim_result", "print_moments", "print_solution", "write_result"]

# What may be appended to the name of a result, and is in the end.
_ENDINGS = ("", "-interrupted", "-failed")


def claim_result(frame: Frame, file_name: str) -> None:
    """Raise before anything is computed if what `write_result` writes has no place."""
    path = Path(file_name)
    named = [path.with_stem(path.stem + ending) for ending in _ENDINGS]
    used = [one.with_suffix(".toml") for one in named]
    frame.claim(*map(str, (*named, *used)))


def write_result(
    result: Solution | Paths | Web,
    frame: Frame,
    file_name: str,
    show: Callable[[Any], None],
    toml: str | None = None,
) -> None:
    """Print a result by `show`, then write it, its configuration, and its figures.

    A part of a result has no figures, and does not take the place of an older,
    complete one.
    """
    # A web is whole, or there is none.
    status = getattr(result, "status", "finished")
    finished = status == "finished"
    if toml is not None:
        about = {**result.provenance, "configuration": toml}
        result = replace(result, provenance=about)
    show(result)
    name = Path(file_name)
    if not finished:
        name = name.with_stem(f"{name.stem}-{status}")
    frame.finish(result, str(name))
    if toml is not None:
        frame.text(toml, str(name.with_suffix(".toml")))
    if finished and frame.figures:
        from fpsolve.plotting.files import save_figures

        for figure in save_figures(result, frame.out, prefix=f"{name.stem}-"):
            typer.echo(figure)


def print_solution(solution: Solution) -> None:
    """Print entropy, minimum, mass error and error estimates at some arclengths."""
    from fpsolve.pages.solution import accuracy_lines, series_columns

    columns = series_columns(solution)
    print_table(columns, zip(*columns.values(), strict=True))
    print_lines(*accuracy_lines(solution), *_duration(solution))


def print_moments(paths: Paths) -> None:
    """Print means and variances with their standard errors at some arclengths."""
    from fpsolve.pages.paths import moment_headings, moment_rows

    print_table(moment_headings(paths), moment_rows(paths))
    print_lines("in parentheses: one standard error, in units of the last digit")
    print_lines(*_duration(paths))


def _duration(result: Solution | Paths) -> list[str]:
    """Say how a run ended and how long it took, if that is known."""
    seconds = result.provenance
    if "wall_seconds" not in seconds:
        return []
    wall, cpu = seconds["wall_seconds"], seconds["cpu_seconds"]
    return [f"{result.status} after {wall:.2f} s ({cpu:.2f} s of CPU time)"]
