"""The progress bar of a run."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

__all__ = ["progress_bar"]


@contextmanager
def progress_bar() -> Iterator[Callable[[int, int, float], None]]:
    """Yield a callback for `solve` that moves a bar; silent outside of a terminal."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    console = Console(stderr=True)
    if not console.is_terminal:
        # A bar that is disabled prints an empty line with older versions of rich.
        yield lambda n_done, n_total, s: None
        return
    columns = (
        TextColumn("s = {task.fields[s]:<8.4g}"),
        BarColumn(),
        TextColumn("{task.completed:.0f}/{task.total:.0f} steps"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("run", total=1, s=0.0)

        def report(n_done: int, n_total: int, s: float) -> None:
            bar.update(task, completed=n_done, total=n_total, s=s)

        yield report
