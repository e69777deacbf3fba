"""`fpsolve rerun`: compute a result again and compare."""

from __future__ import annotations

import os
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fpsolve.cli.errors import FAILED
from fpsolve.cli.frame import Frame, command
from fpsolve.cli.options import Threads, set_threads
from fpsolve.cli.progress import case_bar

if TYPE_CHECKING:
    import xarray as xr

    from fpsolve.results.compare.comparison import Comparison

__all__ = ["rerun"]

File = Annotated[
    Path, typer.Argument(metavar="FILE", help="Result of any command, or of `save`.")
]
Out = Annotated[Path, typer.Option(help="Folder for the new result.")]
Workers = Annotated[
    int | None,
    typer.Option(
        min=0, help="Processes of a study; 0 runs in this one.", show_default="CPUs"
    ),
]
# What a part of the paths has in common with all of them.
_OF_EVERY_PATH = ("xi", "tau", "turns", "kappa", "alpha", "start_xi", "start_tau",
                  "start_turns", "start_kappa")  # fmt: skip


def rerun(
    file: File,
    out: Out = Path("rerun"),
    threads: Threads = None,
    workers: Workers = None,
) -> None:
    """Compute a result again with the parameters in its file, and compare.

    Writes the new result under the same name and prints where both differ. The exit
    code is 0 if they have the same bits, or differ by rounding only (below 1e-10 of
    the largest value of each variable), as they may after a change of machine or of
    versions; then those are named. Otherwise it is 1.
    """
    with command(out) as frame:
        from fpsolve.results.compare.reading import dataset_of, kind_of_dataset
        from fpsolve.results.kinds import KINDS

        old = dataset_of(file, "FILE")
        name = kind_of_dataset(old, "FILE")
        kind = KINDS[name]
        status = str(old.attrs.get("status", "finished"))
        target = _target(file, out, status)
        frame.claim(target.name)
        set_threads(threads)
        _announce(old, kind.words, status)
        given = workers is not None and kind.counts == "cases"
        options = {"workers": workers} if given else {}
        new = _repeat(frame, file, name, kind.counts, options)
        frame.finish(new, target.name)
        _judge(_compared(file, target), status)


def _target(file: Path, out: Path, status: str) -> Path:
    """Return where the new result goes; not where the old one is."""
    stem = file.stem.removesuffix("-interrupted") if status != "failed" else file.stem
    target = out / f"{stem}{file.suffix}"
    if os.path.realpath(target) == os.path.realpath(file):
        raise ValueError(
            f"`--out` must not be the folder of the file, got `{out}`; the result "
            "would take its place."
        )
    return target


def _announce(old: xr.Dataset, words: str, status: str) -> None:
    about = old.attrs.get("command") or old.attrs.get("equation") or ""
    typer.echo(f"repeating {words}: {about}".rstrip(": "))
    if status != "finished":
        article = "an" if status == "interrupted" else "a"
        typer.echo(f"the file holds {article} {status} run; the whole is repeated")


def _repeat(
    frame: Frame, file: Path, name: str, counts: str, options: dict[str, Any]
) -> Any:
    from fpsolve.results.rerun.repeating import rerun as repeat

    bars: dict[str, AbstractContextManager[Any]] = {
        "": nullcontext(),
        "cases": case_bar(name),
    }
    with frame.computing(bar=bars.get(counts), kept="nothing was written") as report:
        progress = {"progress": report} if counts else {}
        return repeat(file, **progress, **options)


def _compared(file: Path, target: Path) -> Comparison:
    from dataclasses import replace

    from fpsolve.cli.compare import print_comparison
    from fpsolve.results.compare.comparing import compare

    found = replace(compare(file, target), names=("the file", "the new result"))
    print_comparison(found)
    return found


def _judge(found: Comparison, status: str) -> None:
    """Exit with 1 unless both are equal, or as equal as rounding lets them be."""
    from fpsolve.results.compare.comparison import ROUNDING

    if found.is_rounding:
        return
    if status == "interrupted":
        common = [one for one in found.differences if "paths" not in found.kind
                  or one.name in _OF_EVERY_PATH]  # fmt: skip
        if all(one.within(ROUNDING) for one in common):
            typer.echo("the part that both have is the same")
            return
    raise typer.Exit(FAILED)
