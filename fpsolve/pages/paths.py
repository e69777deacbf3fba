"""Sampled paths in numbers: the process, moments with standard errors, figures."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.pages.blocks import Block, Facts, Paragraph, Part, Section, Table
from fpsolve.pages.equations import curve_equations, mathml, potential_equation
from fpsolve.pages.figures import drawings
from fpsolve.pages.numbers import evenly, grouped, with_error
from fpsolve.pages.origin import provenance_part, status_notice
from fpsolve.pages.settings import (
    grid_text,
    model_facts,
    process_of,
    start_text,
    units_part,
    unread_model,
    with_options,
)

if TYPE_CHECKING:
    from fpsolve.model.fibre import FibreModel
    from fpsolve.paths.result import Paths

__all__ = ["moment_headings", "moment_rows", "section"]

# Heading: name of the moment.
MOMENTS = {
    "E ξ₁": "mean_xi1",
    "E ξ₂": "mean_xi2",
    "Var ξ₁": "variance_xi1",
    "Var ξ₂": "variance_xi2",
    "E cos α": "mean_cos_alpha",
    "E κ²": "mean_kappa2",
}


def section(paths: Paths, source: str) -> Section:
    """Return the section of a page about paths."""
    # p_S is not the equilibrium of a smooth model.
    variant = ", smooth" if isinstance(paths.model, SmoothLayDownModel) else ""
    return Section("Sampled paths", source, [
        Part("Summary", [status_notice(paths.status, paths.message)]),
        Part("Equation", _equations(paths)),
        Part("Parameters", [Facts(_parameters(paths))]),
        *units_part(process_of(paths.provenance)),
        Part("Moments", _moments(paths)),
        Part("Figures", drawings(paths, variant)),
        provenance_part(paths.provenance, steps="steps of all paths", call=paths.call),
    ])  # fmt: skip


def moment_headings(paths: Paths) -> tuple[str, ...]:
    """The arclength, and those of `MOMENTS` that the paths have."""
    return "s", *(words for words, name in MOMENTS.items() if name in paths.moments())


def moment_rows(paths: Paths) -> list[list[str]]:
    """Arclength, then `MOMENTS` with their standard errors, at some saved s."""
    moments = paths.moments()
    columns = [moments[name] for name in MOMENTS.values() if name in moments]
    return [
        [f"{moments.s[row]:.4g}"]
        + [with_error(float(mean[row]), float(error[row])) for mean, error in columns]
        for row in evenly(len(moments.s))
    ]


def _equations(paths: Paths) -> list[Block]:
    # Files may come without a model.
    model: FibreModel | None = paths.model
    if model is None:
        return unread_model(paths.provenance)
    equations = zip(
        model.process_latex, model.process_equation.split(", "), strict=False
    )
    return [
        *(mathml(latex, plain) for latex, plain in equations),
        potential_equation(model.potential),
        *curve_equations(model.curve),
    ]


def _parameters(paths: Paths) -> list[tuple[str, str]]:
    ensemble, schedule = paths.ensemble, paths.ensemble.schedule
    items = [
        *model_facts(paths.model),
        ("start", _start(paths)),
        ("paths", grouped(ensemble.n_paths) + _kept(paths)),
        ("seed", str(ensemble.seed)),
        ("method", ensemble.method),
        ("step", f"ds = {schedule.ds:g}, {schedule.n_steps} steps from "
                 f"s = {schedule.start:g}"),
    ]  # fmt: skip
    if ensemble.grid is not None:
        items.append(("histogram", grid_text(ensemble.grid)))
    return items


def _start(paths: Paths) -> str:
    configured = start_text(paths.provenance, "start")
    if configured:
        return configured
    to_dict = getattr(paths.initial, "to_dict", None)
    if to_dict is None:
        return "not known"
    options = to_dict()
    return with_options(options.pop("kind"), options)


def _kept(paths: Paths) -> str:
    return "" if paths.kept else ", positions not kept"


def _moments(paths: Paths) -> list[Block]:
    table = Table(
        "Means and variances over the paths.",
        moment_headings(paths), moment_rows(paths),
        "In parentheses: one standard error, in units of the last digit.",
    )  # fmt: skip
    said = (
        "Standard errors are those of independent paths. The bias of the step ds comes "
        "in addition; there is no estimate of it here. fpsolve check compares paths "
        "with the density and estimates both."
    )
    return [table, Paragraph(said)]
