"""`fpsolve limits`: how fast the full equation tends to its two limits."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fpsolve.cli.cases import computing_cases, report_failures
from fpsolve.cli.command import command_line
from fpsolve.cli.console import print_lines, print_table
from fpsolve.cli.frame import Frame, command
from fpsolve.cli.options import NoFigures, Out, Scheduler, Workers
from fpsolve.cli.potentials import PARAMETERS, Kind, Parameters, with_parameters

if TYPE_CHECKING:
    import xarray as xr

    from fpsolve.model.potentials.potential import Potential

__all__ = ["limits"]

LARGE, SMALL, BOTH = "large-noise", "small-noise", "both"
NOISES = {LARGE: (1.4, 2.0, 2.8, 4.0), SMALL: (0.4, 0.2, 0.1)}
QUICK_NOISES = {LARGE: (1.4, 2.0, 2.8), SMALL: (0.4, 0.2)}
# Columns of the table, where nobody sees it wrap.
_WIDTH = 110
_NOTES = {
    LARGE: "orders in ε = 1/A²; *: below three times its numerical error",
    SMALL: "orders in A²; paths: distance by paths and by chance alone",
}

Which = Annotated[
    str, typer.Argument(metavar="[WHICH]", help=f"{LARGE}, {SMALL} or {BOTH}.")
]
Noises = Annotated[
    list[float] | None,
    typer.Option(
        "--noise",
        metavar="A",
        help="Noise amplitude, with one limit; may be given several times.",
        show_default="1.4 to 4 and 0.4 to 0.1, fewer with --quick",
    ),
]
Quick = Annotated[bool, typer.Option("--quick", help="Coarser, for a look.")]


@with_parameters
def limits(
    which: Which = BOTH,
    potential: Kind = "quadratic",
    noise: Noises = None,
    out: Out = Path("results"),
    quick: Quick = False,
    parameters: Parameters = PARAMETERS,
    scheduler: Scheduler = None,
    workers: Workers = None,
    no_figures: NoFigures = False,
) -> None:
    """Measure how the full equation tends to its limits of much and of little noise.

    Much noise: distances of densities and moments to the hydrodynamic limit at a fixed
    slow time, each with the order that is derived for it. Little noise: distance of the
    law of the energy G to the averaged equation (16), by grid and by paths. Every
    finished case is kept in OUT/limit-cases, so that the same command goes on where it
    was stopped.
    """
    with command(out, figures=not no_figures) as frame:
        chosen = _chosen(which, noise)
        one = parameters.make(potential)
        for name in chosen:
            frame.claim(f"{name}-{one.kind}.nc", f"{name}-{one.kind}.png")
        options = {"quick": quick, "client": scheduler, "workers": workers}
        studies = [_study(frame, name, one, noise, options) for name in chosen]
        report_failures(studies, _words)


def _chosen(which: str, noise: list[float] | None) -> list[str]:
    if which not in (LARGE, SMALL, BOTH):
        raise ValueError(f"`WHICH` must be {LARGE}, {SMALL} or {BOTH}, got {which!r}.")
    if noise and which == BOTH:
        raise ValueError(
            f"`--noise` must come with {LARGE} or {SMALL}, got it with {BOTH}; the two "
            "limits need other noises."
        )
    return [LARGE, SMALL] if which == BOTH else [which]


def _study(
    frame: Frame,
    name: str,
    potential: Potential,
    noise: list[float] | None,
    options: dict[str, Any],
) -> xr.Dataset:
    """Compute, print, write and draw one limit."""
    from fpsolve.plotting.limits import plot_large_noise
    from fpsolve.plotting.small_noise import plot_small_noise
    from fpsolve.studies.limits.large_noise import large_noise_limit
    from fpsolve.studies.limits.small_noise import small_noise_limit

    of: dict[str, tuple[Any, Any]] = {
        LARGE: (large_noise_limit, plot_large_noise),
        SMALL: (small_noise_limit, plot_small_noise),
    }
    compute, draw = of[name]
    noises = noise or (QUICK_NOISES if options["quick"] else NOISES)[name]
    file_name = f"{name}-{potential.kind}"
    with computing_cases(frame, file_name, name) as report:
        found: xr.Dataset = compute(
            potential, noises, directory=frame.out / "limit-cases", progress=report,
            **options,
        )  # fmt: skip
    used = command_line(
        "limits", name, potential=potential, noise=noises, quick=options["quick"]
    )
    _print(found, name)
    frame.finish(found.assign_attrs(used), f"{file_name}.nc")
    if bool(found["distance"].notnull().any()):
        frame.figure(draw, found, name=f"{file_name}.png")
    return found


def _print(dataset: xr.Dataset, name: str) -> None:
    """Print one row for every quantity, or for every belt and noise."""
    from fpsolve.pages.limits import large_rows, small_rows

    rows = large_rows(dataset) if name == LARGE else small_rows(dataset)
    print_table(
        rows[0],
        (row.values() for row in rows),
        title=f"{name}, B = {dataset.attrs['formula']}",
        width=_WIDTH,
        style=lambda heading: {
            "justify": "left" if heading == "quantity" else "right",
            "vertical": "bottom",
            "no_wrap": True,
        },
    )
    print_lines(_NOTES[name])


def _words(case: dict[str, Any]) -> str:
    return ", ".join(f"{key} {value}" for key, value in case.items())
