"""`fpsolve energy`: the small-noise limit in numbers and figures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fpsolve.cli.command import command_line
from fpsolve.cli.console import print_lines, print_table
from fpsolve.cli.frame import command
from fpsolve.cli.options import NoFigures, Out
from fpsolve.cli.potentials import PARAMETERS, Kind, Noise, Parameters, with_parameters

if TYPE_CHECKING:
    import xarray as xr

    from fpsolve.reduced.energy.process import EnergyProcess

__all__ = ["energy"]

Energies = Annotated[
    int, typer.Option(min=1, help="Rows of the table, from 0 to g_max.")
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

_FIGURES = [
    f"energy-{name}.png" for name in ("orbits", "coefficients", "eigenfunctions")
]


@with_parameters
def energy(
    potential: Kind = "quadratic",
    noise: Noise = 1.0,
    energies: Energies = 10,
    count: Count = 4,
    passage: Passage = None,
    parameters: Parameters = PARAMETERS,
    out: Out = Path("results"),
    no_figures: NoFigures = False,
) -> None:
    """Compute the energy process of little noise on a belt at rest.

    Prints the circle, the coefficients of the averaged equation (15) and the decay
    rates of (16), with errors, and writes them and figures. The energy is
    G = r exp(-B(r)) sin β, β the angle between fibre and radius.
    """
    with command(out, "energy.nc", *_FIGURES, figures=not no_figures) as frame:
        from fpsolve.plotting.files import possible_figures
        from fpsolve.reduced.energy.process import EnergyProcess
        from fpsolve.studies.energy_tables import tables_dataset

        chosen = parameters.make(potential)
        process = EnergyProcess(chosen, noise)
        walk = None if passage is None else _passage(process, *passage)
        tables = tables_dataset(process, energies, count)
        _print(process, tables)
        if walk is not None:
            typer.echo(walk)
        used = command_line(
            "energy", potential=chosen, noise=noise, energies=energies,
            count=count,
        )  # fmt: skip
        frame.finish(tables.assign_attrs(used), "energy.nc")
        for name, draw in possible_figures(tables).items():
            frame.figure(draw, tables, name=f"energy-{name}.png")


def _passage(process: EnergyProcess, start: float, target: float) -> str:
    found = process.passage(target)
    mean, variance = float(found.mean(start)), float(found.variance(start))
    ends = f"|G| from {start:g} to {target:g}: expected length"
    if not mean < float("inf"):
        return f"{ends} infinite, the circle is never reached"
    return f"{ends} {mean:.6g}, standard deviation {variance**0.5:.4g}"


def _print(process: EnergyProcess, tables: xr.Dataset) -> None:
    from fpsolve.pages.energy import COEFFICIENTS

    print_lines(
        f"energy process, B = {process.potential.formula}, A = {process.noise:g}: "
        f"circle r = {process.radius:.6g}, g_max = {process.g_max:.6g}"
    )
    rows = zip(*(tables[name].to_numpy() for name in COEFFICIENTS), strict=True)
    print_table(
        COEFFICIENTS.values(), ((f"{value:.5g}" for value in row) for row in rows)
    )
    for family, meaning in (("even", "|G|"), ("odd", "sign of G")):
        one = tables.sel(family=family)
        print_lines(f"decay rates, {family} family ({meaning}):")
        for value, error in zip(
            one["eigenvalue"].to_numpy(),
            one["eigenvalue_error"].to_numpy(),
            strict=True,
        ):
            print_lines(f"  {value:.10g} ± {error:.0e}" if error else "  0 exactly")
