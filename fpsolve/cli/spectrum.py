"""`fpsolve spectrum`: eigenvalues of the generator, with errors and sectors."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fpsolve.cli.errors import reported_errors
from fpsolve.cli.potentials import (
    Exponent,
    Sigma1,
    Sigma2,
    Slope,
    make_potential,
)
from fpsolve.cli.run import NoFigures, Out

if TYPE_CHECKING:
    from fpsolve.spectral.spectrum import Spectrum

__all__ = ["spectrum"]

Kind = Annotated[
    str,
    typer.Option("--potential", metavar="KIND", help="quadratic, linear or power."),
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
        from fpsolve.curves import FixedBelt, MovingBelt
        from fpsolve.models import LayDownModel
        from fpsolve.spectral.spectrum import spectrum as compute

        curve = MovingBelt(belt_speed) if belt_speed else FixedBelt()
        chosen = make_potential(potential, sigma1, sigma2, slope, exponent)
        model = LayDownModel(chosen, noise, curve)
        limit = None if memory_limit is None else int(memory_limit * 2**20)
        found = compute(model, count, tolerance=tolerance, memory_limit=limit)
        typer.echo(str(found))
        typer.echo(f"gap {found.gap:.12g} ± {found.gap_error:.1g}")
        _write(found, out, not no_figures)


def _write(found: Spectrum, out: Path, figure: bool) -> None:
    from fpsolve.io.atomic import atomic_path
    from fpsolve.plotting.rates import plot_spectrum
    from fpsolve.plotting.style import RESOLUTION, paper_style
    from fpsolve.studies.rates.dataset import spectrum_dataset

    out.mkdir(parents=True, exist_ok=True)
    numbers = out / "spectrum.nc"
    with atomic_path(numbers) as draft:
        spectrum_dataset(found).to_netcdf(draft, engine="h5netcdf")
    typer.echo(numbers)
    if figure:
        path = out / "spectrum.png"
        with paper_style(), atomic_path(path) as draft:
            plot_spectrum(found).savefig(draft, dpi=RESOLUTION)
        typer.echo(path)
