"""`fpsolve report`: one page about stored results that a person can read."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fpsolve.cli.frame import command

__all__ = ["report"]

Files = Annotated[
    list[Path],
    typer.Argument(
        metavar="FILE...",
        help="Results of `fpsolve run`, `paths`, `check`, `rate`, `spectrum`, `energy` "
        "or `limits`.",
    ),
]
Out = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE.html",
        help="Where the page goes; - is the standard output.",
        show_default="beside the first file",
    ),
]
Title = Annotated[
    str | None,
    typer.Option(help="Title of the page.", show_default="it names the results"),
]
_STANDARD_OUTPUT = Path("-")


def report(files: Files, out: Out = None, title: Title = None) -> None:
    """Write one HTML page about results.

    Equation, parameters, tables with error estimates, figures and provenance of every
    file, on a page that needs neither network nor scripts and can be printed. Nothing
    is written unless every file can be read.
    """
    with command():
        from fpsolve.pages.page import report as write_report
        from fpsolve.pages.page import report_text

        if out == _STANDARD_OUTPUT:
            typer.echo(report_text(files, title=title), nl=False)
            return
        page = page_beside(files[0]) if out is None else out
        typer.echo(write_report(files, page, title=title))


def page_beside(file: Path) -> Path:
    """The page of a result, in the same folder; a folder is none."""
    if not file.name:
        raise ValueError(f"`path` must be the name of a file, got '{file}'.")
    return file.with_suffix(".html")
