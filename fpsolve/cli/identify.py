"""`fpsolve identify`: the parameters of the model from one fibre on the belt."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fpsolve.cli.command import command_line
from fpsolve.cli.console import print_lines, print_pairs, print_table
from fpsolve.cli.frame import Frame, command
from fpsolve.cli.measured import Measured, measured_fibre
from fpsolve.cli.options import METHODS, MODELS, MOTIONS, UNITS, NoFigures, Out
from fpsolve.cli.options import proposing as of

if TYPE_CHECKING:
    from fpsolve.studies.identification.identification import Identification

__all__ = ["identify"]

_NAME = "identification"
# What a parameter is called, and its unit.
_UNITS = {
    "sigma1": "m", "sigma2": "m", "noise": "m^-1/2", "curvature_noise": "m^-3/2",
}  # fmt: skip
_BOTH = "both"
_EXAMPLE = "that of the packaged fibre"


def _length(text: str, **options: Any) -> Any:
    return typer.Option(help=text, metavar="M", **options)


Curve = Annotated[
    Path | None,
    typer.Argument(
        metavar="CURVE.csv",
        help="Points along the fibre, columns eta1, eta2 (or x, y), perhaps s and "
        "fibre, or the curve that `fpsolve string` leaves; without it the packaged "
        "fibre.",
    ),
]
BeltSpeed = Annotated[
    float | None,
    typer.Option(metavar="V", help="Belt speed / spinning speed.",
                 show_default=_EXAMPLE),
]  # fmt: skip
Ds = Annotated[
    float | None,
    _length("Length of fibre between points; those of a column s are resampled to it.",
            show_default="that of the column s"),
]  # fmt: skip
Unit = Annotated[
    str,
    typer.Option(help="Of the lengths in the file: m, cm or mm.", metavar="WORD",
                 autocompletion=of(*UNITS)),
]  # fmt: skip
PositionError = Annotated[
    float | None,
    _length("Standard deviation of the coordinates of a point.", show_default="0"),
]
Model = Annotated[
    str, typer.Option(help="smooth, basic or both.", metavar="WORD",
                      autocompletion=of(*MODELS, _BOTH))
]  # fmt: skip
Method = Annotated[
    str, typer.Option(help="likelihood or functional.", metavar="WORD",
                      autocompletion=of(*METHODS))
]  # fmt: skip
Nozzle = Annotated[
    str | None,
    typer.Option(help="Of a nozzle that moves: rotating or oscillating.",
                 metavar="WORD", show_default="at rest",
                 autocompletion=of(*MOTIONS)),
]  # fmt: skip
AngularSpeed = Annotated[
    float | None,
    typer.Option(metavar="W", help="Of that nozzle, radians per metre of fibre."),
]
Radius = Annotated[
    float | None, _length("Of its motion.", show_default="fitted, with the phase")
]
Phase = Annotated[
    float | None,
    typer.Option(metavar="P", help="At s = 0, in radians; with --radius.",
                 show_default="0"),
]  # fmt: skip
Seed = Annotated[int, typer.Option(help="Of the surrogates.", min=0)]


def identify(
    curve: Curve = None,
    out: Out = Path("results"),
    belt_speed: BeltSpeed = None,
    ds: Ds = None,
    unit: Unit = "m",
    position_error: PositionError = None,
    model: Model = "smooth",
    method: Method = "likelihood",
    nozzle: Nozzle = None,
    angular_speed: AngularSpeed = None,
    radius: Radius = None,
    phase: Phase = None,
    seed: Seed = 0,
    no_figures: NoFigures = False,
) -> None:
    """Find the parameters of the model from one fibre on the belt.

    Prints throwing ranges and noise in SI units with standard errors, 95 % intervals,
    what the fibre cannot determine, and whether fibres of the model are like it; writes
    the identification, which `fpsolve web` and `predict` take, figures and a report.
    """
    with command(out, figures=not no_figures) as frame:
        from fpsolve.studies.identification.identify import identify as identified

        models = MODELS if model == _BOTH else (model,)
        names = [_file_of(name, models) for name in models]
        frame.claim(*names, f"{_NAME}.html", *_pictures())
        given = Measured(
            curve, belt_speed, ds, unit, position_error, nozzle, angular_speed, radius,
            phase,
        )  # fmt: skip
        fibre = measured_fibre(given)
        used = command_line(
            "identify", *([] if curve is None else [str(curve)]),
            belt_speed=belt_speed, ds=ds, unit=unit, position_error=position_error,
            model=model, method=method, nozzle=nozzle, angular_speed=angular_speed,
            radius=radius, phase=phase, seed=seed,
        )  # fmt: skip
        found = {}
        for one, name in zip(models, names, strict=True):
            result = identified(fibre, model=one, method=method, seed=seed)
            if len(models) > 1:
                print_lines(f"The {one} model")
            print_identification(result)
            found[name] = replace(result, provenance={**result.provenance, **used})
        if len(models) > 1:
            print_comparison(dict(zip(models, found.values(), strict=True)))
        _write(frame, found)


def _file_of(model: str, models: tuple[str, ...]) -> str:
    """The first one has the name that other commands take."""
    return f"{_NAME}.nc" if model == models[0] else f"{_NAME}-{model}.nc"


def print_comparison(found: Mapping[str, Identification]) -> None:
    """Print AIC and p-values of models of one fibre side by side."""
    rows = []
    for name, one in found.items():
        worst = min(one.p_values, key=one.p_values.__getitem__)
        aic = "-" if one.aic is None else f"{one.aic:.2f}"
        rows.append((name, aic, f"{one.p_values[worst]:.3f}", worst))
    print_table(("model", "AIC", "smallest p-value", "of the"), rows)
    if all(one.aic is not None for one in found.values()):
        best = min(found, key=lambda name: found[name].aic or 0.0)
        print_lines(f"AIC prefers the {best} model.")


def print_identification(found: Identification) -> None:
    """Print parameters with errors, what is not determined, and goodness of fit."""
    errors, intervals = found.standard_errors, found.interval(0.95)
    print_table(("parameter", "estimate", "error", "95 % interval", "unit"), [
        (name, f"{value:.4g}", f"{errors[name]:.2g}",
         "{:.4g} to {:.4g}".format(*intervals[name]), _UNITS[name])
        for name, value in found.parameters.items()
    ])  # fmt: skip
    print_table(("compared", "p-value"), [
        (name, f"{p:.3f}") for name, p in found.p_values.items()
    ])  # fmt: skip
    sigma1, noise = found.parameters["sigma1"], found.parameters["noise"]
    pairs = [
        ("fibre", f"{found.data.length:.4g} m, every {found.data.ds:.4g} m"),
        ("curve", found.model.curve.formula),
        ("A √σ₁", f"{noise * sigma1**0.5:.4g}"),
    ]
    if "curvature_noise" in found.parameters:
        length = noise / found.parameters["curvature_noise"]
        pairs.append(("R = A/K", f"{length:.4g} m"))
    if found.aic is not None:
        pairs.append(("AIC", f"{found.aic:.2f}"))
    print_pairs(pairs)
    print_lines(
        *(f"{name} is not determined: {why}." for name, why in
          found.undetermined.items()),
        *found.notes,
    )  # fmt: skip


def _pictures() -> tuple[str, str]:
    return f"{_NAME}-fibres.png", f"{_NAME}-increments.png"


def _write(frame: Frame, found: Mapping[str, Identification]) -> None:
    """Every one by its name; figures and a page of all."""
    from fpsolve.pages.page import report_text
    from fpsolve.plotting.identification import plot_identified_fibres, plot_increments

    for name, one in found.items():
        frame.finish(one, name)
    for draw, name in zip(
        (plot_identified_fibres, plot_increments), _pictures(), strict=True
    ):
        frame.figure(draw, *found.values(), name=name)
    frame.text(report_text(list(found.values())), f"{_NAME}.html")
