"""What `run`, `resume` and `paths` leave: a result, its configuration, and figures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

if TYPE_CHECKING:
    from fpsolve.cli.frame import Frame
    from fpsolve.density.solution import Solution
    from fpsolve.paths.result import Paths

__all__ = ["claim_result", "write_result"]

# What may be appended to the name of a result, and is in the end.
_ENDINGS = ("", "-interrupted", "-failed")


def claim_result(frame: Frame, file_name: str) -> None:
    """Raise before anything is computed if what `write_result` writes has no place."""
    path = Path(file_name)
    named = [path.with_stem(path.stem + ending) for ending in _ENDINGS]
    used = [one.with_suffix(".toml") for one in named]
    frame.claim(*map(str, (*named, *used)))


def write_result(
    result: Solution | Paths,
    frame: Frame,
    file_name: str,
    show: Callable[[Any], None],
    toml: str | None = None,
) -> None:
    """Print a result by `show`, then write it, its configuration, and its figures.

    A part of a result has no figures, and does not take the place of an older,
    complete one.
    """
    finished = result.status == "finished"
    if toml is not None:
        about = {**result.provenance, "configuration": toml}
        result = replace(result, provenance=about)
    show(result)
    name = Path(file_name)
    if not finished:
        name = name.with_stem(f"{name.stem}-{result.status}")
    frame.finish(result, str(name))
    if toml is not None:
        frame.text(toml, str(name.with_suffix(".toml")))
    if finished and frame.figures:
        from fpsolve.plotting.files import save_figures

        for figure in save_figures(result, frame.out, prefix=f"{name.stem}-"):
            typer.echo(figure)
