"""What every command does around what it computes: folder, names, bar, files, errors.

A command says what it will write, computes, and finishes its files::

    with command(out, "spectrum.nc", "spectrum.png") as frame:
        with frame.computing() as progress:
            found = ...
        frame.finish(found, "spectrum.nc")
        frame.figure(plot_spectrum, found, name="spectrum.png")
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import typer

from fpsolve.cli.errors import FAILED, INTERRUPTED, fail, reported_errors, say

__all__ = ["Frame", "command"]

# How the message of a result begins that Ctrl-C left; how to go on may follow.
_STOPPED = "stopped by the user"


@contextmanager
def command(
    out: Path | None = None, *names: str, figures: bool = True
) -> Iterator[Frame]:
    """Report errors and warnings as one line each, and give what writes files.

    Parameters
    ----------
    out : Path, optional
        Folder to write to; `Frame.use` names one that is known later only.
    *names : str
        Files that will be written there; `Frame.claim` adds others.
    figures : bool
        Whether `Frame.figure` draws.

    Raises
    ------
    typer.Exit
        With the exit codes of `fpsolve.cli.errors.reported_errors`: before anything is
        computed if the folder cannot be made or a name is taken by what is no file.
    """
    with reported_errors():
        frame = Frame(figures=figures)
        if out is not None:
            frame.use(out, *names)
        yield frame


@dataclass
class Frame:
    """The folder of a command, and the one way to write there.

    Files appear complete or not at all, in a folder that is made when the first one is
    written, and each one is printed.

    Parameters
    ----------
    out : Path
        Folder to write to.
    figures : bool
        Whether `figure` draws.
    """

    out: Path = Path()
    figures: bool = True

    def use(self, out: Path, *names: str) -> None:
        """Write to this folder, which is there or can be made, files of these names."""
        from fpsolve._support.files import check_folder

        self.out = check_folder(out, "--out")
        self.claim(*names)

    def claim(self, *names: str) -> None:
        """Raise before anything is computed if a name is taken by what is no file."""
        from fpsolve._support.targets import check_targets

        check_targets(self.out / name for name in names)

    @contextmanager
    def computing(
        self,
        *,
        bar: AbstractContextManager[Any] | None = None,
        keep: Callable[[Any], object] | None = None,
        kept: str = "",
    ) -> Iterator[Any]:
        """Move a bar while something is computed, and keep what is left when it stops.

        Parameters
        ----------
        bar : context manager, optional
            What gives the callback; by default a bar that counts steps.
        keep : callable, optional
            Takes what a run that is interrupted, or cannot go on, had recorded.
        kept : str
            What to say of it after Ctrl-C.
        """
        from fpsolve.cli import progress
        from fpsolve.errors import RunError, RunInterrupted

        try:
            # Not `from ... import progress_bar`: a test replaces it in its module.
            with progress.progress_bar() if bar is None else bar as report:
                yield report
        except RunInterrupted as interrupt:
            part = interrupt.solution
            if keep is not None and part is not None:
                keep(part)
            what = f"; {kept}" if kept else ""
            fail(f"interrupted{what}{_how_to_go_on(part)}", INTERRUPTED)
        except RunError as error:
            if keep is not None and error.solution is not None:
                _keep_if_possible(error.solution, keep)
            fail(error, FAILED)

    def finish(self, result: Any, name: str) -> None:
        """Write a result or a dataset, and print its path."""
        typer.echo(self.save(result, name))

    def save(self, result: Any, name: str) -> Path:
        """Write it and print nothing."""
        import xarray as xr

        from fpsolve._support.netcdf import write_dataset

        if isinstance(result, xr.Dataset):
            return write_dataset(result, self.path(name))
        saved: Path = result.save(self.path(name))
        return saved

    def figure(self, draw: Callable[..., Any], *of: Any, name: str) -> None:
        """Draw `draw(*of)` as PNG and print its path, unless figures are not wanted."""
        if not self.figures:
            return
        from fpsolve.plotting.files import write_figure
        from fpsolve.plotting.style import paper_style

        path = self.path(name)
        with paper_style():
            typer.echo(write_figure(draw(*of), path))

    def text(self, text: str, name: str) -> None:
        """Write a text, and print its path."""
        from fpsolve._support.files import atomic_path

        path = self.path(name)
        with atomic_path(path) as draft:
            draft.write_text(text, encoding="utf-8")
        typer.echo(path)

    def path(self, name: str) -> Path:
        """Return the place of a file in the folder, which is made."""
        from fpsolve._support.files import made_folder

        return made_folder(self.out, "--out") / name


def _how_to_go_on(part: Any) -> str:
    """What the message of a partial result adds; that of a dataset is a variable."""
    message = getattr(part, "message", None)
    return message.removeprefix(_STOPPED) if isinstance(message, str) else ""


def _keep_if_possible(part: Any, keep: Callable[[Any], object]) -> None:
    """Keep a part; where there is no room, what stopped the run counts."""
    try:
        keep(part)
    except OSError as error:
        say(f"warning: what was recorded cannot be written: {error}")
