"""The result of a run as a short table."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fpsolve.density.solution import Solution

__all__ = ["print_solution"]


def print_solution(solution: Solution) -> None:
    """Print entropy, minimum, mass error and error estimates at some arclengths."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    from fpsolve.pages.solution import accuracy_lines, series_columns

    console = Console(highlight=False, markup=False)
    table = Table(box=box.SIMPLE_HEAD)
    columns = series_columns(solution)
    for name in columns:
        table.add_column(name, justify="right")
    for row in zip(*columns.values(), strict=True):
        table.add_row(*row)
    console.print(table)
    for line in accuracy_lines(solution):
        console.print(line)
    seconds = solution.provenance
    if "wall_seconds" in seconds:
        console.print(
            f"{solution.status} after {seconds['wall_seconds']:.2f} s "
            f"({seconds['cpu_seconds']:.2f} s of CPU time)"
        )
