"""Studies of many cases: their bar, what is kept of them, and those that failed."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager
from functools import partial
from typing import TYPE_CHECKING, Any

import typer

from fpsolve.cli.errors import FAILED, say
from fpsolve.cli.frame import Frame
from fpsolve.cli.progress import case_bar

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["computing_cases", "report_failures"]


def computing_cases(frame: Frame, name: str, title: str) -> AbstractContextManager[Any]:
    """Count cases, and write those that are finished as `name`-interrupted.nc."""
    keep = partial(frame.save, name=f"{name}-interrupted.nc")
    return frame.computing(
        bar=case_bar(title), keep=keep, kept="what was finished is kept"
    )


def report_failures(
    studies: Iterable[xr.Dataset], words: Callable[[dict[str, Any]], str]
) -> None:
    """Say which cases failed; the exit code is 1 if none was finished.

    Parameters
    ----------
    studies : iterable of xarray.Dataset
        With `status` and `message` of every case.
    words : callable
        Names a case, given its coordinates.
    """
    finished = 0
    for study in studies:
        failed = (study["status"] == "failed").to_numpy()
        for place in zip(*failed.nonzero(), strict=True):
            at = dict(zip(study["status"].dims, place, strict=True))
            case = {str(key): study[key][n].item() for key, n in at.items()}
            say(f"warning: {words(case)} failed: {study['message'].isel(at).item()}")
        finished += int((study["status"] == "finished").sum())
    if not finished:
        raise typer.Exit(FAILED)
