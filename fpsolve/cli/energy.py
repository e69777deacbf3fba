"""`fpsolve energy`: the small-noise limit in numbers and figures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fpsolve.cli.command import command_line
from fpsolve.cli.completion import KINDS, proposing
from fpsolve.cli.errors import reported_errors
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

    from fpsolve.reduced.energy.process import EnergyProcess

__all__ = ["energy"]

Kind = Annotated[
    str,
    typer.Option(
        "--potential",
        metavar="KIND",
        help="quadratic, linear or power.",
        autocompletion=proposing(*KINDS),
    ),
]
Noise = Annotated[float, typer.Option(metavar="A", help="Noise amplitude.")]
Energies = Annotated[
    int, typer.Option("--energies", min=1, help="Rows of the table, from 0 to g_max.")
]
Count = Annotated[
    int, typer.Option("--count", "-n", min=1, help="Eigenvalues of each family.")
]
Passage = Annotated[
    tuple[float, float] | None,
    typer.Option(
        metavar="FROM TARGET",
        help="Expected length of fibre until the energy has come from one to another.",
    ),
]

# What is drawn, and by which function.
_FIGURES = {
    "orbits": "orbits",
    "coefficients": "energy_coefficients",
    "eigenfunctions": "energy_eigenfunctions",
}


def energy(
    potential: Kind = "quadratic",
    noise: Noise = 1.0,
    energies: Energies = 10,
    count: Count = 4,
    passage: Passage = None,
    sigma1: Sigma1 = 1.0,
    sigma2: Sigma2 = None,
    slope: Slope = 1.0,
    exponent: Exponent = 4.0,
    out: Out = Path("results"),
    no_figures: NoFigures = False,
) -> None:
    """Compute the energy process of little noise on a belt at rest.

    Prints the circle, the coefficients of the averaged equation (15) and the decay
    rates of (16), with errors, and writes them and figures. The energy is
    G = r exp(-B(r)) sin β, β the angle between fibre and radius.
    """
    with reported_errors():
        from fpsolve._support.files import check_folder

        check_folder(out, "--out")
        from fpsolve.cli.writing import check_outputs
        from fpsolve.reduced.energy.process import EnergyProcess
        from fpsolve.studies.energy_tables import tables_dataset

        check_outputs(out, "energy.nc", *(f"energy-{name}.png" for name in _FIGURES))
        chosen = make_potential(potential, sigma1, sigma2, slope, exponent)
        process = EnergyProcess(chosen, noise)
        walk = None if passage is None else _passage(process, *passage)
        tables = tables_dataset(process, energies, count)
        _print(process, tables)
        if walk is not None:
            typer.echo(walk)
        used = command_line(
            "energy", **potential_options(chosen), noise=noise, energies=energies,
            count=count,
        )  # fmt: skip
        _write(process, tables.assign_attrs(used), out, not no_figures)


def _passage(process: EnergyProcess, start: float, target: float) -> str:
    found = process.passage(target)
    mean, variance = float(found.mean(start)), float(found.variance(start))
    ends = f"|G| from {start:g} to {target:g}: expected length"
    if not mean < float("inf"):
        return f"{ends} infinite, the circle is never reached"
    return f"{ends} {mean:.6g}, standard deviation {variance**0.5:.4g}"


def _print(process: EnergyProcess, tables: xr.Dataset) -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table

    from fpsolve.pages.energy import COEFFICIENTS

    console = Console(highlight=False, markup=False)
    console.print(
        f"energy process, B = {process.potential.formula}, A = {process.noise:g}: "
        f"circle r = {process.radius:.6g}, g_max = {process.g_max:.6g}"
    )
    table = Table(box=box.SIMPLE_HEAD)
    for title in COEFFICIENTS.values():
        table.add_column(title, justify="right")
    for row in zip(*(tables[name].to_numpy() for name in COEFFICIENTS), strict=True):
        table.add_row(*(f"{value:.5g}" for value in row))
    console.print(table)
    for family, meaning in (("even", "|G|"), ("odd", "sign of G")):
        one = tables.sel(family=family)
        console.print(f"decay rates, {family} family ({meaning}):")
        pairs = zip(one["eigenvalue"].to_numpy(), one["eigenvalue_error"].to_numpy(),
                    strict=True)  # fmt: skip
        for value, error in pairs:
            console.print(f"  {value:.10g} ± {error:.0e}" if error else "  0 exactly")


def _write(
    process: EnergyProcess, tables: xr.Dataset, out: Path, figures: bool
) -> None:
    from fpsolve._support.files import made_folder
    from fpsolve._support.netcdf import write_dataset

    made_folder(out, "--out")
    typer.echo(write_dataset(tables, out / "energy.nc"))
    if figures:
        _draw(process, out)


def _draw(process: EnergyProcess, out: Path) -> None:
    from fpsolve._support.files import atomic_path
    from fpsolve.plotting import energy as plotting
    from fpsolve.plotting.style import RESOLUTION, paper_style

    for name in _FIGURES:
        plot = getattr(plotting, f"plot_{_FIGURES[name]}")
        path = out / f"energy-{name}.png"
        with paper_style(), atomic_path(path) as draft:
            plot(process).savefig(draft, dpi=RESOLUTION)
        typer.echo(path)
