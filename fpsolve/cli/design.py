"""`fpsolve design`: the process that lays the most even web at fixed base weight."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fpsolve.cli.console import print_pairs, print_table
from fpsolve.cli.frame import command
from fpsolve.cli.options import NoFigures, Out

if TYPE_CHECKING:
    from fpsolve.cli.config.design import DesignConfig
    from fpsolve.studies.design.result import WebDesign

__all__ = ["design"]

Config = Annotated[
    Path | None,
    typer.Argument(
        metavar="CONFIG.toml",
        help="TOML file with sections [process], [design] and [bounds]; without it the "
        "packaged example.",
    ),
]
Front = Annotated[
    int | None,
    typer.Option(
        help="Throughputs at which the most even web is searched too.", min=0,
        show_default="of the file",
    ),
]  # fmt: skip
Webs = Annotated[
    int | None,
    typer.Option(
        help="Webs laid of the optimum for every zone, 0 for none.", min=0,
        show_default="of the file",
    ),
]  # fmt: skip


def design(
    config: Config = None,
    out: Out = Path("results"),
    front: Front = None,
    n_webs: Webs = None,
    no_figures: NoFigures = False,
) -> None:
    """Find the process that lays the most even web, or meets a bound at least cost.

    At fixed base weight, within bounds, in SI units. Prints the optimal parameters with
    their errors, what bounds hold them, and the variation of the web as predicted and
    as laid; writes the design and a figure.
    """
    with command(out, figures=not no_figures) as frame:
        from fpsolve.plotting.design import plot_web_design
        from fpsolve.studies.design.design_web import design_web

        chosen = _config(config).changed("design", front=front, n_webs=n_webs)
        name = chosen.output.name
        frame.figures = chosen.output.figures and not no_figures
        frame.claim(chosen.output.file_name, f"{name}.png")
        process, asked = chosen.build()
        found = design_web(process, **asked)
        print_design(found)
        about = {**found.provenance, "configuration": chosen.to_toml()}
        frame.finish(replace(found, provenance=about), chosen.output.file_name)
        frame.figure(plot_web_design, found, name=f"{name}.png")


def print_design(found: WebDesign) -> None:
    """Print parameters with errors and bounds, and CV predicted and laid."""
    headings = ("parameter", "start", "optimum", "error", "bounds")
    print_table(headings, _parameters(found))
    print_table(("zone", "start", "CV", "laid", "z"), _zones(found))
    print_pairs([
        ("base weight", f"{found.base_weight:.4g} g/m²"),
        ("throughput", f"{found.throughput:.4g} kg/h per metre of width"),
        ("held by", ", ".join(found.active) or "no bound"),
        ("predictions", str(found.n_predictions)),
    ])  # fmt: skip


def _parameters(found: WebDesign) -> list[tuple[str, ...]]:
    columns = zip(
        found.parameters, found.history[0], found.values, found.value_errors,
        found.lower, found.upper, strict=True,
    )  # fmt: skip
    return [
        (name, f"{start:.4g}", f"{value:.4g}", f"{100 * error:.1g} %",
         f"{low:g} to {high:g}")
        for name, start, value, error, low, high in columns
        if name in found.free
    ]  # fmt: skip


def _zones(found: WebDesign) -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = []
    for n, zone in enumerate(found.zones):
        laid, z = "–", "–"
        if found.n_webs:
            laid = _said(found.simulated[n], found.standard_errors[n])
            z = f"{found.z[n]:.1f}"
        start = f"{100 * found.history_cv[0, n]:.4g} %"
        cv = _said(found.cv[n], found.errors[n])
        rows.append((f"{zone:g} m", start, cv, laid, z))
    return rows


def _said(value: float, error: float) -> str:
    return f"{100 * value:.4g} ± {100 * error:.1g} %"


def _config(path: Path | None) -> DesignConfig:
    from fpsolve.cli.config.design import DesignConfig
    from fpsolve.cli.config.reading import DESIGN_EXAMPLE, example_path, load_config

    return load_config(path or example_path(DESIGN_EXAMPLE), DesignConfig)
