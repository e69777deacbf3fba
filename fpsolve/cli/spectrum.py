"""`fpsolve spectrum`: eigenvalues of the generator, with errors and sectors."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

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
    from fpsolve.spectral.eigen.spectrum import Spectrum

__all__ = ["spectrum"]

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
Count = Annotated[int, typer.Option("--count", "-n", min=1, help="How many.")]
Tolerance = Annotated[float, typer.Option(help="Relative error of every eigenvalue.")]
BeltSpeed = Annotated[
    float, typer.Option(metavar="V", help="Belt speed, for quadratic potentials.")
]
Memory = Annotated[
    float | None,
    typer.Option(
        "--memory-limit",
        metavar="MIB",
        help="Memory for the largest basis, in MiB.",
        show_default="256",
    ),
]


def spectrum(
    potential: Kind = "quadratic",
    noise: Noise = 1.0,
    count: Count = 6,
    tolerance: Tolerance = 1e-10,
    belt_speed: BeltSpeed = 0.0,
    sigma1: Sigma1 = 1.0,
    sigma2: Sigma2 = None,
    slope: Slope = 1.0,
    exponent: Exponent = 4.0,
    memory_limit: Memory = None,
    out: Out = Path("results"),
    no_figures: NoFigures = False,
) -> None:
    """Compute the eigenvalues that decide how fast the density converges.

    Prints them with errors, residuals and sectors, the slowest first, and writes them
    and a figure. The gap is the rate at which p/p_S - 1 decays in the end.
    """
    with reported_errors():
        from fpsolve._support.files import check_folder

        check_folder(out, "--out")
        from fpsolve._support.checks import check_positive
        from fpsolve.cli.writing import check_outputs
        from fpsolve.model.curves.belts import FixedBelt, MovingBelt
        from fpsolve.model.laydown import LayDownModel
        from fpsolve.spectral.eigen.spectrum import spectrum as compute
        from fpsolve.studies.recipe import recipe

        check_outputs(out, "spectrum.nc", "spectrum.png")
        curve = MovingBelt(belt_speed) if belt_speed else FixedBelt()
        chosen = make_potential(potential, sigma1, sigma2, slope, exponent)
        model = LayDownModel(chosen, noise, curve)
        limit = None
        if memory_limit is not None:
            limit = math.ceil(check_positive("--memory-limit", memory_limit) * 2**20)
        found = compute(model, count, tolerance=tolerance, memory_limit=limit)
        typer.echo(str(found))
        typer.echo(f"gap {found.gap:.12g} ± {found.gap_error:.1g}")
        options: dict[str, Any] = {"n_eigenvalues": count, "tolerance": tolerance}
        if limit is not None:
            options["memory_limit"] = limit
        used = command_line(
            "spectrum", **potential_options(chosen), noise=noise, count=count,
            tolerance=tolerance, belt_speed=belt_speed or None,
            memory_limit=memory_limit,
        )  # fmt: skip
        again = {**recipe("spectrum", {"model": model, **options}), **used}
        _write(found, again, out, not no_figures)


def _write(found: Spectrum, again: dict[str, str], out: Path, figure: bool) -> None:
    from fpsolve._support.files import atomic_path, made_folder
    from fpsolve._support.netcdf import write_dataset
    from fpsolve.plotting.rates import plot_spectrum
    from fpsolve.plotting.style import RESOLUTION, paper_style
    from fpsolve.spectral.eigen.dataset import spectrum_dataset

    made_folder(out, "--out")
    dataset = spectrum_dataset(found).assign_attrs(again)
    typer.echo(write_dataset(dataset, out / "spectrum.nc"))
    if figure:
        path = out / "spectrum.png"
        with paper_style(), atomic_path(path) as draft:
            plot_spectrum(found).savefig(draft, dpi=RESOLUTION)
        typer.echo(path)
