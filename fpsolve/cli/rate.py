"""`fpsolve rate`: how fast the density converges, against the noise."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fpsolve.cli.cases import computing_cases, report_failures
from fpsolve.cli.command import command_line
from fpsolve.cli.console import print_lines, print_table
from fpsolve.cli.frame import Frame, command
from fpsolve.cli.options import PARTS, NoFigures, Out, Scheduler, Workers, proposing
from fpsolve.cli.potentials import PARAMETERS, Kinds, Parameters, with_parameters

if TYPE_CHECKING:
    import xarray as xr

    from fpsolve.model.potentials.potential import Potential

__all__ = ["rate"]

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
Tolerance = Annotated[
    float | None,
    typer.Option(
        help="Relative tolerance of the gap.", show_default="1e-8, quick 1e-6"
    ),
]
# Of the names of a study's file and figures.
_ENDINGS = (".nc", ".png", "-variance.png")


@with_parameters
def rate(
    potential: Kinds = None,
    noise: Noises = None,
    out: Out = Path("results"),
    quick: Quick = False,
    part: Parts = None,
    tolerance: Tolerance = None,
    parameters: Parameters = PARAMETERS,
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
    with command(out, figures=not no_figures) as frame:
        amplitudes = noise if noise else _default_noises(quick)
        chosen = [
            parameters.make(kind) for kind in potential or ("quadratic", "linear")
        ]
        for one in chosen:
            frame.claim(*(f"rate-{one.kind}{ending}" for ending in _ENDINGS))
        frame.claim("rate-integral.png")
        options = {
            "quick": quick, "tolerance": tolerance, "client": scheduler,
            "workers": workers,
        }  # fmt: skip
        studies = [_study(frame, one, amplitudes, part, options) for one in chosen]
        _draw(frame, [one.kind for one in chosen], studies)
        report_failures(studies, "{part} at A = {noise:g}".format_map)


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
    frame: Frame,
    potential: Potential,
    noises: list[float],
    wanted: list[str] | None,
    options: dict[str, Any],
) -> xr.Dataset:
    """Compute, print and write the study of one potential."""
    from fpsolve.pages.rates import rate_columns
    from fpsolve.studies.rates.rate_versus_noise import rate_versus_noise

    name, parts = f"rate-{potential.kind}", _parts_for(potential, wanted)
    with computing_cases(frame, name, f"B = {potential.formula}") as report:
        found = rate_versus_noise(
            potential, noises, parts=parts, directory=frame.out / "rate-cases",
            progress=report, **options,
        )  # fmt: skip
    columns = rate_columns(found)
    rows = zip(*columns.values(), strict=True)
    print_table(columns, rows, title=f"B = {potential.formula}")
    print_lines("in parentheses: the error in units of the last digit")
    used = command_line(
        "rate", potential=potential, noise=noises, part=parts,
        quick=options["quick"], tolerance=options["tolerance"],
    )  # fmt: skip
    frame.finish(found.assign_attrs(used), f"{name}.nc")
    return found


def _draw(frame: Frame, kinds: list[str], studies: list[xr.Dataset]) -> None:
    """Draw what was computed, for all potentials and for each."""
    from fpsolve.plotting import rates

    if all("inverse_decay_rate" in one for one in studies):
        frame.figure(rates.plot_inverse_decay_rate, studies, name="rate-integral.png")
    for kind, one in zip(kinds, studies, strict=True):
        name = f"rate-{kind}"
        if "gap" in one or "branch_rate" in one:
            frame.figure(rates.plot_rates, one, name=f"{name}.png")
        if "asymptotic_variance" in one:
            draw = rates.plot_asymptotic_variance
            frame.figure(draw, one, name=f"{name}-variance.png")
