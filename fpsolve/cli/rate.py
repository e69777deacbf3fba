"""`fpsolve rate`: how fast the density converges, against the noise."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fpsolve.cli.command import command_line
from fpsolve.cli.completion import KINDS, PARTS, proposing
from fpsolve.cli.errors import FAILED, INTERRUPTED, fail, reported_errors
from fpsolve.cli.potentials import (
    Exponent,
    Sigma1,
    Sigma2,
    Slope,
    make_potential,
    potential_options,
)
from fpsolve.cli.run import NoFigures, Out

if TYPE_CHECKING:
    import xarray as xr

    from fpsolve.model.potentials.potential import Potential

__all__ = ["case_bar", "rate", "save_figure"]

Potentials = Annotated[
    list[str] | None,
    typer.Option(
        "--potential",
        metavar="KIND",
        help="quadratic, linear or power; may be given several times.",
        autocompletion=proposing(*KINDS),
        show_default="quadratic and linear",
    ),
]
Noises = Annotated[
    list[float] | None,
    typer.Option(
        "--noise",
        metavar="A",
        help="Noise amplitude; may be given several times.",
        show_default="nine from 0.25 to 4, with --quick three from 0.5 to 2",
    ),
]
Quick = Annotated[bool, typer.Option("--quick", help="Coarser and shorter runs.")]
Parts = Annotated[
    list[str] | None,
    typer.Option(
        "--part",
        metavar="NAME",
        help="relaxation, evolution, branches, gap or variance; may be given several "
        "times.",
        autocompletion=proposing(*PARTS),
        show_default="all",
    ),
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS",
        help="Run on the dask scheduler at this address.",
        show_default=False,
    ),
]
Workers = Annotated[
    int | None,
    typer.Option(min=0, help="Processes; 0 runs in this one.", show_default="CPUs"),
]
Tolerance = Annotated[
    float | None,
    typer.Option(
        help="Relative tolerance of the gap.", show_default="1e-8, quick 1e-6"
    ),
]
# Of the names of a study's file and figures.
_ENDINGS = (".nc", ".png", "-variance.png")


def rate(
    potential: Potentials = None,
    noise: Noises = None,
    out: Out = Path("results"),
    quick: Quick = False,
    part: Parts = None,
    tolerance: Tolerance = None,
    sigma1: Sigma1 = 1.0,
    sigma2: Sigma2 = None,
    slope: Slope = 1.0,
    exponent: Exponent = 4.0,
    scheduler: Scheduler = None,
    workers: Workers = None,
    no_figures: NoFigures = False,
) -> None:
    """Measure, compute and bound the rate of convergence against the noise.

    For each potential: the inverse decay rate of figure 5 from runs with errors, the
    decay rate of the entropy, the spectral gap with its branches, asymptotic variances
    of averages, proven bounds and asymptotes. Every finished case is kept in
    OUT/rate-cases, so that the same command goes on where it was stopped.
    """
    with reported_errors():
        from fpsolve._support.files import check_folder

        check_folder(out, "--out")
        from fpsolve.cli.writing import check_outputs
        from fpsolve.errors import RunInterrupted

        amplitudes = noise if noise else _default_noises(quick)
        chosen = [
            make_potential(kind, sigma1, sigma2, slope, exponent)
            for kind in potential or ("quadratic", "linear")
        ]
        for one in chosen:
            names = (f"rate-{one.kind}{ending}" for ending in _ENDINGS)
            check_outputs(out, *names, "rate-integral.png")
        options = {
            "quick": quick, "tolerance": tolerance, "client": scheduler,
            "workers": workers,
        }  # fmt: skip
        studies = []
        for one in chosen:
            parts = _parts_for(one, part)
            try:
                studies.append(_study(one, amplitudes, parts, out, options))
                used = command_line(
                    "rate", **potential_options(one), noise=amplitudes, part=parts,
                    quick=quick, tolerance=tolerance,
                )  # fmt: skip
                studies[-1] = studies[-1].assign_attrs(used)
            except RunInterrupted as interrupt:
                _write(interrupt.solution, out, "-interrupted")
                fail("interrupted; what was finished is kept", INTERRUPTED)
            print_rates(studies[-1])
            typer.echo(_write(studies[-1], out))
        if not no_figures:
            _draw(studies, out)
        _report_failures(studies)


def print_rates(dataset: xr.Dataset) -> None:
    """Print one row for every noise: integral, rates, gap, bound."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    from fpsolve.pages.rates import rate_columns

    console = Console(highlight=False, markup=False)
    table = Table(box=box.SIMPLE_HEAD, title=f"B = {dataset.attrs['formula']}")
    columns = rate_columns(dataset)
    for name in columns:
        table.add_column(name, justify="right")
    for row in zip(*columns.values(), strict=True):
        table.add_row(*row)
    console.print(table)
    console.print("in parentheses: the error in units of the last digit")


def _default_noises(quick: bool) -> list[float]:
    low, high, count = (0.5, 2.0, 3) if quick else (0.25, 4.0, 9)
    ratio = (high / low) ** (1 / (count - 1))
    return [float(f"{low * ratio**n:.4g}") for n in range(count)]


def _parts_for(potential: Potential, wanted: list[str] | None) -> list[str] | None:
    """The parts asked for, without the one that only quadratic potentials have."""
    from fpsolve.model.potentials.quadratic import QuadraticPotential

    if wanted is None or isinstance(potential, QuadraticPotential):
        return wanted
    return [part for part in wanted if part != "evolution"] or wanted


def _study(
    potential: Potential,
    noises: list[float],
    parts: list[str] | None,
    out: Path,
    options: dict[str, Any],
) -> xr.Dataset:
    from fpsolve.studies.rates.rate_versus_noise import rate_versus_noise

    store = None if potential.kind in ("callable", "custom") else out / "rate-cases"
    with case_bar(f"B = {potential.formula}") as report:
        return rate_versus_noise(
            potential, noises, parts=parts, directory=store, progress=report, **options
        )


@contextmanager
def case_bar(title: str) -> Iterator[Callable[[int, int, Any], None]]:
    """Show a bar that counts cases; silent outside of a terminal."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    console = Console(stderr=True)
    columns = (
        TextColumn(title), BarColumn(),
        TextColumn("{task.completed:.0f}/{task.total:.0f} cases"),
        TimeRemainingColumn(),
    )  # fmt: skip
    with Progress(
        *columns, console=console, transient=True, disable=not console.is_terminal
    ) as bar:
        task = bar.add_task("rate", total=1)

        def report(n_done: int, n_total: int, _: Any) -> None:
            bar.update(task, completed=n_done, total=n_total)

        yield report


def _write(dataset: xr.Dataset, out: Path, suffix: str = "") -> Path:
    import json

    from fpsolve._support.files import made_folder
    from fpsolve._support.netcdf import write_dataset

    made_folder(out, "--out")
    kind = json.loads(dataset.attrs["potential"])["kind"]
    return write_dataset(dataset, out / f"rate-{kind}{suffix}.nc")


def _draw(studies: list[xr.Dataset], out: Path) -> None:
    import json

    from fpsolve.plotting.rates import (
        plot_asymptotic_variance,
        plot_inverse_decay_rate,
        plot_rates,
    )

    if all("inverse_decay_rate" in one for one in studies):
        save_figure(plot_inverse_decay_rate(studies), out / "rate-integral.png")
    for one in studies:
        kind = json.loads(one.attrs["potential"])["kind"]
        if "gap" in one or "branch_rate" in one:
            save_figure(plot_rates(one), out / f"rate-{kind}.png")
        if "asymptotic_variance" in one:
            path = out / f"rate-{kind}-variance.png"
            save_figure(plot_asymptotic_variance(one), path)


def save_figure(figure: Any, path: Path) -> None:
    """Write a figure as PNG, whole or not at all, and print where it is."""
    from fpsolve._support.files import atomic_path
    from fpsolve.plotting.style import RESOLUTION, paper_style

    with paper_style(), atomic_path(path) as draft:
        figure.savefig(draft, dpi=RESOLUTION)
    typer.echo(path)


def _report_failures(studies: list[xr.Dataset]) -> None:
    """Say which cases failed; the exit code is 1 if none was finished."""
    from fpsolve.cli.errors import say

    finished = 0
    for study in studies:
        for noise in study["noise"].to_numpy():
            for part in study["part"].to_numpy():
                one = study.sel(noise=noise, part=part)
                status, message = str(one["status"].item()), str(one["message"].item())
                finished += status == "finished"
                if status == "failed":
                    say(f"warning: {part} at A = {noise:g} failed: {message}")
    if not finished:
        raise typer.Exit(FAILED)
