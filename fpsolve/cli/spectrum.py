"""`fpsolve spectrum`: eigenvalues of the generator, with errors and sectors."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

from fpsolve.cli.command import command_line
from fpsolve.cli.frame import command
from fpsolve.cli.options import NoFigures, Out
from fpsolve.cli.potentials import PARAMETERS, Kind, Noise, Parameters, with_parameters

__all__ = ["spectrum"]

Count = Annotated[int, typer.Option("--count", "-n", min=1, help="How many.")]
Tolerance = Annotated[
    float | None,
    typer.Option(
        help="Relative error of every eigenvalue.",
        show_default="1e-10, with a relaxation length 1e-6",
    ),
]
Length = Annotated[
    float | None,
    typer.Option(
        metavar="R", help="Relaxation length R of the curvature: a smooth fibre."
    ),
]
BeltSpeed = Annotated[
    float, typer.Option(metavar="V", help="Belt speed, for quadratic potentials.")
]
Memory = Annotated[
    float | None,
    typer.Option(
        metavar="MIB",
        help="Memory for the largest basis, in MiB.",
        show_default="256, with a relaxation length 2048",
    ),
]
WorkLimit = Annotated[
    float | None,
    typer.Option(
        metavar="N",
        help="Numbers gone through before it is refused; 1e10 take some 20 s.",
        show_default="1e10, with a relaxation length 2e10",
    ),
]


@with_parameters
def spectrum(
    potential: Kind = "quadratic",
    noise: Noise = 1.0,
    count: Count = 6,
    tolerance: Tolerance = None,
    belt_speed: BeltSpeed = 0.0,
    relaxation_length: Length = None,
    parameters: Parameters = PARAMETERS,
    memory_limit: Memory = None,
    work_limit: WorkLimit = None,
    out: Out = Path("results"),
    no_figures: NoFigures = False,
) -> None:
    """Compute the eigenvalues that decide how fast the density converges.

    Prints them with errors, residuals and sectors, the slowest first, and writes them
    and a figure. The gap is the rate at which p/p_S - 1 decays in the end.
    With a relaxation length they are those of a smooth fibre, about a
    quadratic potential.
    """
    names = "spectrum.nc", "spectrum.png"
    with command(out, *names, figures=not no_figures) as frame:
        from fpsolve._support.checks import check_positive
        from fpsolve.model.curves.belts import FixedBelt, MovingBelt
        from fpsolve.model.fibre import FibreModel
        from fpsolve.model.laydown import LayDownModel
        from fpsolve.model.smooth import SmoothLayDownModel
        from fpsolve.plotting.spectrum import plot_spectrum
        from fpsolve.spectral.eigen.spectrum import spectrum as compute

        curve = MovingBelt(belt_speed) if belt_speed else FixedBelt()
        chosen = parameters.make(potential)
        model: FibreModel = LayDownModel(chosen, noise, curve)
        if relaxation_length is not None:
            model = SmoothLayDownModel(chosen, relaxation_length, noise, curve)
        options: dict[str, Any] = {"n_eigenvalues": count, "tolerance": tolerance}
        if memory_limit is not None:
            limit = check_positive("--memory-limit", memory_limit) * 2**20
            options["memory_limit"] = math.ceil(limit)
        if work_limit is not None:
            options["work_limit"] = check_positive("--work-limit", work_limit)
        found = compute(model, **options)
        typer.echo(str(found))
        typer.echo(f"gap {found.gap:.12g} ± {found.gap_error:.1g}")
        used = command_line(
            "spectrum", potential=chosen, noise=noise, count=count,
            tolerance=tolerance, belt_speed=belt_speed or None,
            relaxation_length=relaxation_length,
            memory_limit=memory_limit, work_limit=work_limit,
        )  # fmt: skip
        found = replace(found, provenance={**found.provenance, **used})
        frame.finish(found, names[0])
        frame.figure(plot_spectrum, found, name=names[1])
