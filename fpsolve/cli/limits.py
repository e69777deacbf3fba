"""`fpsolve limits`: how fast the full equation tends to its two limits."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fpsolve.cli.command import command_line
from fpsolve.cli.completion import KINDS, proposing
from fpsolve.cli.errors import FAILED, INTERRUPTED, fail, reported_errors, say
from fpsolve.cli.potentials import (
    Exponent,
    Sigma1,
    Sigma2,
    Slope,
    make_potential,
    potential_options,
)
from fpsolve.cli.rate import Scheduler, Workers, case_bar, save_figure
from fpsolve.cli.run import NoFigures, Out

if TYPE_CHECKING:
    import xarray as xr

    from fpsolve.model.potentials.potential import Potential

__all__ = ["limits"]

LARGE, SMALL, BOTH = "large-noise", "small-noise", "both"
NOISES = {LARGE: (1.4, 2.0, 2.8, 4.0), SMALL: (0.4, 0.2, 0.1)}
QUICK_NOISES = {LARGE: (1.4, 2.0, 2.8), SMALL: (0.4, 0.2)}
_WIDTH = 110
_ENDINGS = ("nc", "png")

Which = Annotated[
    str, typer.Argument(metavar="[WHICH]", help=f"{LARGE}, {SMALL} or {BOTH}.")
]
Kind = Annotated[
    str,
    typer.Option(
        "--potential",
        metavar="KIND",
        help="quadratic, linear or power.",
        autocompletion=proposing(*KINDS),
    ),
]
Noises = Annotated[
    list[float] | None,
    typer.Option(
        "--noise",
        metavar="A",
        help="Noise amplitude, with one limit; may be given several times.",
        show_default="1.4 to 4 and 0.4 to 0.1, fewer with --quick",
    ),
]
Quick = Annotated[bool, typer.Option("--quick", help="Coarser, for a look.")]


def limits(
    which: Which = BOTH,
    potential: Kind = "quadratic",
    noise: Noises = None,
    out: Out = Path("results"),
    quick: Quick = False,
    sigma1: Sigma1 = 1.0,
    sigma2: Sigma2 = None,
    slope: Slope = 1.0,
    exponent: Exponent = 4.0,
    scheduler: Scheduler = None,
    workers: Workers = None,
    no_figures: NoFigures = False,
) -> None:
    """Measure how the full equation tends to its limits of much and of little noise.

    Much noise: distances of densities and moments to the hydrodynamic limit at a fixed
    slow time, each with the order that is derived for it. Little noise: distance of the
    law of the energy G to the averaged equation (16), by grid and by paths. Every
    finished case is kept in OUT/limit-cases, so that the same command goes on where it
    was stopped.
    """
    with reported_errors():
        from fpsolve._support.files import check_folder
        from fpsolve.cli.writing import check_outputs

        check_folder(out, "--out")
        chosen = _chosen(which, noise)
        one = make_potential(potential, sigma1, sigma2, slope, exponent)
        for name in chosen:
            check_outputs(out, *(f"{name}-{one.kind}.{ending}" for ending in _ENDINGS))
        options = {"quick": quick, "client": scheduler, "workers": workers}
        studies = [
            _study(name, one, noise, out, options, not no_figures) for name in chosen
        ]
        _report_failures(studies)


def _chosen(which: str, noise: list[float] | None) -> list[str]:
    if which not in (LARGE, SMALL, BOTH):
        raise ValueError(f"`WHICH` must be {LARGE}, {SMALL} or {BOTH}, got {which!r}.")
    if noise and which == BOTH:
        raise ValueError(
            f"`--noise` must come with {LARGE} or {SMALL}, got it with {BOTH}; the two "
            "limits need other noises."
        )
    return [LARGE, SMALL] if which == BOTH else [which]


def _study(
    name: str,
    potential: Potential,
    noise: list[float] | None,
    out: Path,
    options: dict[str, Any],
    figures: bool,
) -> xr.Dataset:
    """Compute, print, write and draw one limit."""
    from fpsolve.errors import RunInterrupted

    noises = noise or (QUICK_NOISES if options["quick"] else NOISES)[name]
    compute = _studies()[name]
    try:
        with case_bar(name) as report:
            found: xr.Dataset = compute(
                potential, noises, directory=out / "limit-cases", progress=report,
                **options,
            )  # fmt: skip
    except RunInterrupted as interrupt:
        _write(interrupt.solution, name, out, "-interrupted")
        fail("interrupted; what was finished is kept", INTERRUPTED)
    used = command_line(
        "limits", name, **potential_options(potential), noise=noises,
        quick=options["quick"],
    )  # fmt: skip
    found = found.assign_attrs(used)
    _print(found, name)
    typer.echo(_write(found, name, out))
    if figures:
        _draw(found, name, out)
    return found


def _studies() -> dict[str, Any]:
    from fpsolve.studies.limits.large_noise import large_noise_limit
    from fpsolve.studies.limits.small_noise import small_noise_limit

    return {LARGE: large_noise_limit, SMALL: small_noise_limit}


def _print(dataset: xr.Dataset, name: str) -> None:
    """Print one row for every quantity, or for every belt and noise."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    from fpsolve.pages.limits import large_rows, small_rows

    table = Table(box=box.SIMPLE_HEAD, title=f"{name}, B = {dataset.attrs['formula']}")
    rows = large_rows(dataset) if name == LARGE else small_rows(dataset)
    for heading in rows[0]:
        table.add_column(heading, justify="left" if heading == "quantity" else "right",
                         vertical="bottom", no_wrap=True)  # fmt: skip
    for row in rows:
        table.add_row(*row.values())
    # Where nobody sees it wrap, the table may be as wide as it is.
    width = None if Console().is_terminal else _WIDTH
    console = Console(highlight=False, markup=False, width=width)
    console.print(table)
    if name == LARGE:
        console.print("orders in ε = 1/A²; *: below three times its numerical error")
    else:
        console.print("orders in A²; paths: distance by paths and by chance alone")


def _write(dataset: xr.Dataset, name: str, out: Path, suffix: str = "") -> Path:
    from fpsolve._support.files import made_folder
    from fpsolve._support.netcdf import write_dataset

    made_folder(out, "--out")
    kind = json.loads(dataset.attrs["potential"])["kind"]
    return write_dataset(dataset, out / f"{name}-{kind}{suffix}.nc")


def _draw(dataset: xr.Dataset, name: str, out: Path) -> None:
    from fpsolve.plotting.limits import plot_large_noise
    from fpsolve.plotting.small_noise import plot_small_noise

    kind = json.loads(dataset.attrs["potential"])["kind"]
    draw = {LARGE: plot_large_noise, SMALL: plot_small_noise}[name]
    if bool(dataset["distance"].notnull().any()):
        save_figure(draw(dataset), out / f"{name}-{kind}.png")


def _report_failures(studies: list[xr.Dataset]) -> None:
    """Say which cases failed; the exit code is 1 if none was finished."""
    finished = 0
    for study in studies:
        for place in zip(
            *(study["status"] == "failed").to_numpy().nonzero(), strict=True
        ):
            at = dict(zip(study["status"].dims, place, strict=True))
            message = str(study["message"].isel(at).item())
            where = ", ".join(f"{key} {study[key][n].item()}" for key, n in at.items())
            say(f"warning: {where} failed: {message}")
        finished += int((study["status"] == "finished").sum())
    if not finished:
        raise typer.Exit(FAILED)
