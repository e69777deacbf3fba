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
    from fpsolve.evolution.saved import Saved
    from fpsolve.paths.fibres.fibre_curve import FibreCurve
    from fpsolve.studies.identification.comparison import IdentificationComparison
    from fpsolve.studies.identification.identification import Identification

__all__ = ["identify"]

_NAME = "identification"
# What a parameter is called, and its unit.
_UNITS = {
    "sigma1": "m", "sigma2": "m", "noise": "m^-1/2", "curvature_noise": "m^-3/2",
}  # fmt: skip
_BOTH = "both"
# The smooth model has the name that other commands take.
_BOTH_FILES = (f"{_NAME}.nc", f"{_NAME}-basic.nc", f"{_NAME}-comparison.nc")
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
Pixel = Annotated[
    float | None,
    _length("Size of a pixel, where the table is in pixels.",
            show_default="the table is in --unit"),
]  # fmt: skip
PositionError = Annotated[
    float | None,
    _length("Standard deviation of the coordinates of a point.",
            show_default="that of rounding to the digits of the table"),
]  # fmt: skip
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
    pixel: Pixel = None,
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
        names = _BOTH_FILES if model == _BOTH else _BOTH_FILES[:1]
        frame.claim(*names, f"{_NAME}.html", *_pictures())
        given = Measured(
            curve, belt_speed, ds, unit, position_error, nozzle, angular_speed, radius,
            phase, pixel,
        )  # fmt: skip
        fibre = measured_fibre(given)
        used = command_line(
            "identify", *([] if curve is None else [str(curve)]),
            belt_speed=belt_speed, ds=ds, unit=unit, pixel=pixel,
            position_error=position_error, model=model, method=method, nozzle=nozzle,
            angular_speed=angular_speed, radius=radius, phase=phase, seed=seed,
        )  # fmt: skip
        if model == _BOTH:
            _finish_both(frame, fibre, method, seed, used)
        else:
            _finish_one(frame, fibre, model, method, seed, used)


def _finish_one(frame: Frame, fibre: FibreCurve, model: str, method: str, seed: int,
                used: dict[str, Any]) -> None:  # fmt: skip
    """Identify one model; print and write it."""
    from fpsolve.studies.identification.identify import identify as identified

    result = identified(fibre, model=model, method=method, seed=seed)
    print_identification(result)
    found = replace(result, provenance={**result.provenance, **used})
    _write(frame, {f"{_NAME}.nc": found}, found)


def _finish_both(frame: Frame, fibre: FibreCurve, method: str, seed: int,
                 used: dict[str, Any]) -> None:  # fmt: skip
    """Identify both models; print and write each, and the comparison."""
    from fpsolve.studies.identification.compare_models import compare_models

    result = compare_models(fibre, method=method, seed=seed)
    for name, one in result.identifications.items():
        print_lines(f"The {name} model")
        print_identification(one)
    print_comparison(result)
    basic, smooth = (
        replace(one, provenance={**one.provenance, **used})
        for one in result.identifications.values()
    )
    found = replace(result, provenance={**result.provenance, **used})
    _write(frame, dict(zip(_BOTH_FILES, (smooth, basic, found), strict=True)), found)


def print_comparison(found: IdentificationComparison) -> None:
    """Print AIC and p-values of both models side by side, and what they mean."""
    rows, weights = [], found.weights
    for name, one in found.identifications.items():
        aic = "-" if one.aic is None else f"{one.aic:.2f}"
        weight = "-" if weights is None else f"{weights[name]:.3g}"
        smallest, together = min(one.p_values.values()), found.p_values[name]
        rows.append((name, aic, weight, f"{smallest:.3f}", f"{together:.3f}"))
    print_table(("model", "AIC", "weight", "smallest p-value", "p-value of all"), rows)
    print_lines(*found.verdict)


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


def _write(
    frame: Frame,
    files: Mapping[str, Saved],
    found: Identification | IdentificationComparison,
) -> None:
    """Every file by its name; figures and a page."""
    from fpsolve.pages.page import report_text
    from fpsolve.plotting.identification import plot_identified_fibres, plot_increments

    for name, one in files.items():
        frame.finish(one, name)
    for draw, name in zip(
        (plot_identified_fibres, plot_increments), _pictures(), strict=True
    ):
        frame.figure(draw, found, name=name)
    frame.text(report_text(found), f"{_NAME}.html")
