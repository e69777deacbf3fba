"""The progress bar of a run, and that of a study."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Any

__all__ = ["case_bar", "progress_bar"]

Report = Callable[[int, int, Any], None]


def progress_bar() -> AbstractContextManager[Report]:
    """Give a callback for `solve` that moves a bar; silent outside of a terminal."""
    return _bar("s = {task.fields[s]:<8.4g}", "steps")


def case_bar(title: str) -> AbstractContextManager[Report]:
    """Give one that counts the cases of a study."""
    return _bar(title, "cases")


@contextmanager
def _bar(text: str, counted: str) -> Iterator[Report]:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    console = Console(stderr=True)
    if not console.is_terminal:
        # A bar that is disabled prints an empty line with older versions of rich.
        yield lambda n_done, n_total, s: None
        return
    columns = (
        TextColumn(text),
        BarColumn(),
        TextColumn(f"{{task.completed:.0f}}/{{task.total:.0f}} {counted}"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("run", total=1, s=0.0)

        def report(n_done: int, n_total: int, s: Any) -> None:
            bar.update(task, completed=n_done, total=n_total, s=s)

        yield report
