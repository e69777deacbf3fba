"""`fpsolve spectrum`: eigenvalues of the generator, with errors and sectors."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fpsolve.cli.command import command_line
from fpsolve.cli.frame import command
from fpsolve.cli.options import NoFigures, Out
from fpsolve.cli.potentials import PARAMETERS, Kind, Noise, Parameters, with_parameters

if TYPE_CHECKING:
    from fpsolve.cli.config.spectrum import SpectrumConfig
    from fpsolve.model.fibre import FibreModel
    from fpsolve.model.potentials.potential import Potential

__all__ = ["spectrum"]

# Options that say which model, as a file does.
OF_THE_MODEL = (
    "potential", "sigma1", "sigma2", "slope", "exponent", "noise", "belt_speed",
    "relaxation_length",
)  # fmt: skip

Config = Annotated[
    Path | None,
    typer.Argument(
        metavar="CONFIG.toml",
        help="TOML file whose model is taken; without it that of the options.",
    ),
]

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
    context: typer.Context,
    config: Config = None,
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
    With a relaxation length they are those of a smooth fibre, about a quadratic
    potential. The model is that of a file for `fpsolve run` or `fpsolve paths`, if one
    is given, or else that of the options.
    """
    names = "spectrum.nc", "spectrum.png"
    with command(out, *names, figures=not no_figures) as frame:
        from fpsolve._support.checks import check_positive
        from fpsolve.plotting.spectrum import plot_spectrum
        from fpsolve.spectral.eigen.spectrum import spectrum as compute

        arguments: list[str] = []
        if config is None:
            chosen = parameters.make(potential)
            model = _model(chosen, noise, belt_speed, relaxation_length)
            used: dict[str, Any] = {
                "potential": chosen, "noise": noise, "belt_speed": belt_speed or None,
                "relaxation_length": relaxation_length,
            }  # fmt: skip
            notes = {}
        else:
            described = _described(config, context)
            model = described.build_model()
            arguments, used = [config.name], {}
            notes = {"configuration": described.to_toml()}
        options: dict[str, Any] = {"n_eigenvalues": count, "tolerance": tolerance}
        if memory_limit is not None:
            limit = check_positive("--memory-limit", memory_limit) * 2**20
            options["memory_limit"] = math.ceil(limit)
        if work_limit is not None:
            options["work_limit"] = check_positive("--work-limit", work_limit)
        found = compute(model, **options)
        typer.echo(str(found))
        typer.echo(f"gap {found.gap:.12g} ± {found.gap_error:.1g}")
        notes |= command_line(
            "spectrum", *arguments, **used, count=count, tolerance=tolerance,
            memory_limit=memory_limit, work_limit=work_limit,
        )  # fmt: skip
        found = replace(found, provenance={**found.provenance, **notes})
        frame.finish(found, names[0])
        frame.figure(plot_spectrum, found, name=names[1])


def _described(config: Path, context: typer.Context) -> SpectrumConfig:
    """What a file describes; ValueError if options say which model, too."""
    from fpsolve.cli.config.reading import load_config
    from fpsolve.cli.config.spectrum import SpectrumConfig

    for name in OF_THE_MODEL:
        source = context.get_parameter_source(name)
        if source is not None and source.name == "COMMANDLINE":
            raise ValueError(
                f"`--{name.replace('_', '-')}` must not be given beside a file, got "
                f"both it and `{config}`; change the file, or leave it out."
            )
    return load_config(config, SpectrumConfig)


def _model(
    potential: Potential, noise: float, belt_speed: float, length: float | None
) -> FibreModel:
    """The model of the options, smooth with a relaxation length."""
    from fpsolve.model.curves.belts import FixedBelt, MovingBelt
    from fpsolve.model.laydown import LayDownModel
    from fpsolve.model.smooth import SmoothLayDownModel

    curve = MovingBelt(belt_speed) if belt_speed else FixedBelt()
    if length is None:
        return LayDownModel(potential, noise, curve)
    return SmoothLayDownModel(potential, length, noise, curve)
