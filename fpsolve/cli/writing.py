"""What a command leaves behind: a result, the configuration used, and figures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

if TYPE_CHECKING:
    from fpsolve.paths import Paths
    from fpsolve.solution import Solution

__all__ = ["write_result"]


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
    from fpsolve.io import save
    from fpsolve.io.atomic import atomic_path, made_folder

    made_folder(out, "--out")
    toml = config.to_toml()
    result = replace(result, provenance={**result.provenance, "configuration": toml})
    show(result)
    path = out / config.output.file_name
    if result.status != "finished":
        path = path.with_stem(f"{path.stem}-{result.status}")
    typer.echo(save(result, path))
    used = path.with_suffix(".toml")
    with atomic_path(used) as draft:
        draft.write_text(toml, encoding="utf-8")
    typer.echo(used)
    if figures:
        from fpsolve.plotting import save_figures

        for figure in save_figures(result, out, prefix=f"{path.stem}-"):
            typer.echo(figure)
