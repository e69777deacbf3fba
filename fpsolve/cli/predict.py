"""`fpsolve predict`: how even a web will be, without laying it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fpsolve.cli.command import command_line
from fpsolve.cli.console import print_lines, print_pairs, print_table
from fpsolve.cli.frame import command
from fpsolve.cli.identified import (
    From,
    read_identification,
    tables_of_identification,
)
from fpsolve.cli.options import POSITIONS, NoFigures, Out, proposing
from fpsolve.cli.potentials import PARAMETERS, Kind, Noise, Parameters, with_parameters
from fpsolve.cli.web import (
    BeltSpeed,
    RelaxationLength,
    Spacing,
    options_of_model,
    tables_of,
)

if TYPE_CHECKING:
    from fpsolve.cli.config.web import WebConfig
    from fpsolve.studies.identification.identification import Identification
    from fpsolve.web.prediction import WebPrediction

__all__ = ["predict"]

# Sides of zones in throwing ranges, where none are given.
_ZONES = (0.1, 0.3, 1.0, 3.0, 10.0)
Config = Annotated[
    Path | None,
    typer.Argument(
        metavar="CONFIG.toml",
        help="TOML file of `fpsolve web`; without it the packaged example in SI units, "
        "or what options of the model say.",
    ),
]
Positions = Annotated[
    str | None,
    typer.Option(
        help="Spinning positions: regular or random.", metavar="WORD",
        show_default="of the file", autocompletion=proposing(*POSITIONS),
    ),
]  # fmt: skip
Zone = Annotated[
    list[float] | None,
    typer.Option(
        help="Side of square zones; may be given several times.",
        show_default="of the file, or 0.1 to 10 throwing ranges",
    ),
]
Band = Annotated[
    list[str] | None,
    typer.Option(
        metavar="SHORT:LONG",
        help="Band of wavelengths for the cloudiness; may be given several times.",
    ),
]
Tolerance = Annotated[float, typer.Option(help="Relative error of every CV.")]


@with_parameters
def predict(
    context: typer.Context,
    config: Config = None,
    out: Out = Path("results"),
    spacing: Spacing = None,
    positions: Positions = None,
    zone: Zone = None,
    band: Band = None,
    tolerance: Tolerance = 5e-3,
    from_: From = None,
    potential: Kind = "quadratic",
    noise: Noise = 1.0,
    belt_speed: BeltSpeed = 0.1,
    relaxation_length: RelaxationLength = None,
    parameters: Parameters = PARAMETERS,
    no_figures: NoFigures = False,
) -> None:
    """Predict how even a web will be, from the generator of one fibre.

    No fibre is laid. Prints the variation of square zones, MD/CD ratio and cloudiness
    with bounds of their errors, and writes them and a figure. Lengths are metres for a
    process in SI units and an identification, whose errors are carried to the
    variation, else throwing ranges. Of a file sections [process] or
    [potential], [model] and [curve] count, and of [web] spacing, positions and zones.
    """
    with command(out, figures=not no_figures) as frame:
        from fpsolve.plotting.predicted_web import plot_predicted_web

        made, options = parameters.make(potential), options_of_model(context)
        physics = {
            "potential": made.to_dict(),
            "model": {"noise": noise, "relaxation_length": relaxation_length},
            "curve": {"kind": "moving_belt", "speed": belt_speed},
        }
        identified = None
        if from_ is not None:
            identified = read_identification(from_, config, options)
        chosen = _config(
            tables_of(config, physics, options)
            if identified is None
            else tables_of_identification(identified)
        )
        name = f"{chosen.output.name}-prediction"
        frame.claim(f"{name}.nc", f"{name}.png")
        asked: dict[str, Any] = {
            "spacing": chosen.web.spacing if spacing is None else spacing,
            "positions": chosen.web.positions if positions is None else positions,
            "zones": zone or chosen.web.zones or _default_zones(chosen, identified),
            "bands": [_pair(one) for one in band or ()],
            "tolerance": tolerance,
        }
        found = _predicted(chosen, asked, identified)
        toml = chosen.to_toml()
        of_model = {
            "potential": made, "noise": noise, "belt_speed": belt_speed,
            "relaxation_length": relaxation_length,
        }  # fmt: skip
        used = command_line(
            "predict", *([] if config is None else [str(config)]), spacing=spacing,
            positions=positions, zone=zone, band=band, tolerance=tolerance,
            **(of_model if options else {}), **{"from": from_},
        )  # fmt: skip
        about = {**found.provenance, "configuration": toml, **used}
        frame.finish(replace(found, provenance=about), f"{name}.nc")
        frame.figure(plot_predicted_web, found, name=f"{name}.png")


def _predicted(
    chosen: WebConfig, asked: dict[str, Any], identified: Identification | None
) -> WebPrediction:
    """The prediction, printed; with slopes where errors of parameters go on to it."""
    from fpsolve.studies.identification.carried import why_not_carried
    from fpsolve.web.predict import predict_web

    model: Any = chosen.laid_model()
    if identified is None:
        found = predict_web(model, **asked)
        print_prediction(found, "" if chosen.process is None else " m")
        return found
    reason = why_not_carried(identified)
    found = predict_web(model, **asked, gradients=reason is None)
    if reason is None:
        found = identified.carry_errors(found)
    print_prediction(found, " m")
    if reason is not None:
        print_lines(f"Errors of the parameters are not carried on: {reason}.")
    return found


def print_prediction(found: WebPrediction, unit: str) -> None:
    """Print variation, cloudiness and ratio with bounds of their errors.

    Where it has them, also standard errors of CV by those of identified parameters.
    """
    carried = found.carried_errors
    rows = [
        (f"{zone:g}{unit}", f"{_said(cv, error)} %")
        for zone, cv, error in zip(found.zones, found.cv, found.errors, strict=True)
    ]
    headings: tuple[str, ...] = ("zone", "CV")
    if carried is not None:
        headings = (*headings, "of the parameters")
        more = [f"± {100 * error:.2g} %" for error in carried]
        print_table(
            headings, [(*row, one) for row, one in zip(rows, more, strict=True)]
        )
    else:
        print_table(headings, rows)
    if found.cloudiness.size:
        print_table(("wavelengths", "part of CV²"), [
            (f"{short:g} to {long:g}{unit}", f"{_said(part, error)} %")
            for short, long, part, error in zip(
                found.shortest, found.longest, found.cloudiness,
                found.cloudiness_errors, strict=True,
            )
        ])  # fmt: skip
    per = f"{unit}⁻¹" if unit else ""
    pairs = [
        ("length per area", f"{found.mean:.6g}{per}"),
        ("MD/CD", f"{found.machine_cross_ratio:.4f}"),
    ]
    print_pairs(pairs)


def _config(tables: dict[str, Any]) -> WebConfig:
    from fpsolve.cli.config.reading import check_config
    from fpsolve.cli.config.web import WebConfig

    return check_config(tables, "options", WebConfig)


def _default_zones(chosen: WebConfig, identified: Identification | None) -> list[float]:
    from fpsolve.model.process import Process

    model = chosen.laid_model()
    if isinstance(model, Process):
        return [zone * max(model.sigma1, model.sigma2) for zone in _ZONES]
    if identified is not None:
        widest = max(identified.parameters[name] for name in ("sigma1", "sigma2"))
        return [zone * float(f"{widest:.0e}") for zone in _ZONES]
    return list(_ZONES)


def _pair(text: str) -> tuple[float, float]:
    """Return SHORT:LONG as numbers."""
    words = text.split(":")
    try:
        short, long = map(float, words)
    except ValueError:
        raise ValueError(
            f"`--band` must be SHORT:LONG, two wavelengths, got {text!r}."
        ) from None
    return short, long


def _said(value: float, error: float) -> str:
    return f"{100 * value:.5g} ± {100 * error:.1g}"
