"""Tables and lines on the standard output, as every command prints them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

__all__ = ["print_lines", "print_pairs", "print_table"]


def print_table(
    headings: Iterable[str],
    rows: Iterable[Iterable[str]],
    *,
    title: str | None = None,
    width: int | None = None,
    style: Callable[[str], dict[str, Any]] = lambda heading: {"justify": "right"},
) -> None:
    """Print rows of cells below their headings.

    Parameters
    ----------
    headings : iterable of str
    rows : iterable of iterable of str
    title : str, optional
    width : int, optional
        Width where nobody sees it wrap; a terminal has its own.
    style : callable, optional
        Options of rich for the column below a heading.
    """
    from rich import box
    from rich.console import Console
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, title=title)
    for heading in headings:
        table.add_column(heading, **style(heading))
    for row in rows:
        table.add_row(*row)
    width = None if Console().is_terminal else width
    Console(highlight=False, markup=False, width=width).print(table)


def print_pairs(pairs: Iterable[tuple[str, str]]) -> None:
    """Print names with what they stand for beside them."""
    from rich.console import Console
    from rich.table import Table

    table = Table.grid(padding=(0, 2))
    for name, text in pairs:
        table.add_row(name, text)
    Console(highlight=False, markup=False).print(table)


def print_lines(*lines: str, whole: bool = False) -> None:
    """Print lines, wrapped to the terminal between words, or left whole."""
    from rich.console import Console

    console = Console(highlight=False, markup=False, soft_wrap=whole)
    for line in lines:
        console.print(line)
