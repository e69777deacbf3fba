"""What a command leaves behind: a result, the configuration used, and figures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

if TYPE_CHECKING:
    from fpsolve.density.solution import Solution
    from fpsolve.paths.result import Paths

__all__ = ["check_outputs", "check_result", "write_result"]

# What may be appended to the name of a result, and is in the end.
_ENDINGS = ("", "-interrupted", "-failed")


def check_outputs(out: Path, *names: str) -> None:
    """Raise before anything is computed if a name is taken by what is no file."""
    from fpsolve._support.targets import check_targets

    check_targets(out / name for name in names)


def check_result(config: Any, out: Path) -> None:
    """Do so for what `write_result` would write."""
    path = Path(config.output.file_name)
    named = [path.with_stem(path.stem + ending) for ending in _ENDINGS]
    used = [one.with_suffix(".toml") for one in named]
    check_outputs(out, *map(str, (*named, *used)))


def write_result(
    result: Solution | Paths,
    config: Any,
    out: Path,
    *,
    figures: bool,
    show: Callable[[Any], None],
) -> None:
    """Print a result by `show`, then write it, its configuration, and its figures.

    A part of a result does not take the place of an older, complete one.
    """
    from fpsolve._support.files import atomic_path, made_folder

    made_folder(out, "--out")
    toml = config.to_toml()
    result = replace(result, provenance={**result.provenance, "configuration": toml})
    show(result)
    path = out / config.output.file_name
    if result.status != "finished":
        path = path.with_stem(f"{path.stem}-{result.status}")
    typer.echo(result.save(path))
    used = path.with_suffix(".toml")
    with atomic_path(used) as draft:
        draft.write_text(toml, encoding="utf-8")
    typer.echo(used)
    if figures:
        from fpsolve.plotting.files import save_figures

        for figure in save_figures(result, out, prefix=f"{path.stem}-"):
            typer.echo(figure)
