"""`fpsolve compare`: two results of the same kind, number by number."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fpsolve.cli.console import print_lines, print_table
from fpsolve.cli.errors import FAILED
from fpsolve.cli.frame import command
from fpsolve.cli.options import NoFigures

if TYPE_CHECKING:
    from fpsolve.results.compare.comparison import Comparison
    from fpsolve.results.compare.differences import Difference

__all__ = ["compare", "print_comparison"]

First = Annotated[Path, typer.Argument(metavar="A", help="A result.")]
Second = Annotated[
    Path, typer.Argument(metavar="B", help="Another result of the same kind.")
]
Out = Annotated[
    Path | None, typer.Option(help="Folder for the figure; by default that of B.")
]
Tolerance = Annotated[
    float | None,
    typer.Option(
        metavar="R",
        help="Let every variable differ by R times its largest value.",
        show_default="none, the same bits",
    ),
]
_MOST_ROWS = 15


def compare(
    a: First,
    b: Second,
    out: Out = None,
    tolerance: Tolerance = None,
    no_figures: NoFigures = False,
) -> None:
    """Compare two results: differences, their errors, parameters, environment.

    Prints the variables that differ, the largest difference of each and where it is,
    and writes a figure of them. The exit code is 0 if both are equal, or within the
    tolerance, and 1 if they are not.
    """
    with command(figures=not no_figures) as frame:
        from fpsolve._support.checks import check_positive
        from fpsolve.plotting.differences import plot_comparison
        from fpsolve.results.compare.comparing import compare as compare_results

        if tolerance is not None:
            check_positive("--tolerance", tolerance)
        found = compare_results(a, b)
        print_comparison(found)
        if found.differing:
            frame.out = b.parent if out is None else out
            name = f"{a.stem}-{b.stem}-difference.png"
            frame.figure(plot_comparison, found, name=name)
        if tolerance is not None:
            inside = "within" if found.within(tolerance) else "beyond"
            typer.echo(f"{inside} {tolerance:g} of the largest value of each variable")
        if not (found.equal or (tolerance and found.within(tolerance))):
            raise typer.Exit(FAILED)


def print_comparison(comparison: Comparison) -> None:
    """Print the verdict, a row for every variable that differs, and what else does."""
    from fpsolve.results.compare.comparison import sections, verdict

    a, b = comparison.names
    print_lines(f"A = {a}, B = {b}: {comparison.kind}")
    if comparison.differing:
        print_table(
            ("variable", "|B − A|", "relative", "at", "in errors"),
            map(_row, comparison.differing[:_MOST_ROWS]),
            style=lambda heading: {"justify": "left", "no_wrap": heading != "at"},
        )
        print_lines("relative: to the largest |A|; in errors: of A and B together")
    hidden = len(comparison.differing) - _MOST_ROWS
    if hidden > 0:
        print_lines(f"and {hidden} more variables")
    print_lines(verdict(comparison), whole=True)
    for title, entries in sections(comparison).items():
        if entries:
            print_lines(f"{title}:")
            print_lines(*(f"  {entry}" for entry in entries), whole=True)


def _row(one: Difference) -> tuple[str, ...]:
    from fpsolve.results.compare.comparison import place_text

    units = " σ" if one.statistical else ""
    errors = "" if one.in_errors is None else f"{one.in_errors:.2g}{units}"
    place = place_text(one)
    return one.name, f"{one.largest:.3g}", f"{one.relative:.2g}", place, errors
