"""A density p(s) in numbers: what was solved, series at saved s, errors, figures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve.evolution.series import is_extrapolated
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.pages.blocks import Block, Facts, Notice, Paragraph, Part, Section, Table
from fpsolve.pages.equations import model_equations
from fpsolve.pages.figures import drawings
from fpsolve.pages.numbers import formatted
from fpsolve.pages.origin import provenance_part, suggestion
from fpsolve.pages.runs import (
    NOT_EXTRAPOLATED,
    error_table,
    outcome,
    saved_rows,
    step_text,
)
from fpsolve.pages.settings import (
    curve_text,
    grid_text,
    process_of,
    start_text,
    units_part,
    unread_model,
    with_options,
)

if TYPE_CHECKING:
    from fpsolve.density.solution import Solution
    from fpsolve.model.fibre import FibreModel
    from fpsolve.model.process import Process

__all__ = ["accuracy_lines", "section", "series_columns"]

_NAMES = {"density_l1": "saved densities p, in the L¹ norm"}


def section(solution: Solution, source: str) -> Section:
    """Return the section of a page about a solution."""
    process = process_of(solution.provenance)
    # p_S, whose contours are drawn else, is not the equilibrium of a smooth model.
    variant = ", smooth" if isinstance(solution.model, SmoothLayDownModel) else ""
    return Section("Density of a run", source, [
        Part("Summary", _summary(solution)),
        Part("Equation", _equations(solution)),
        Part("Parameters", [Facts(_parameters(solution))]),
        *units_part(process),
        Part("Numbers at saved arclengths", _numbers(solution, process)),
        Part("Accuracy", _accuracy(solution)),
        Part("Figures", drawings(solution, variant)),
        provenance_part(solution.provenance, call=solution.call),
    ])  # fmt: skip


def series_columns(solution: Solution) -> dict[str, list[str]]:
    """Entropy, minimum, mass error and boundary mass near evenly spaced saved s."""
    rows = _steps(solution)
    series, errors = solution.series, solution.errors or {}
    entropy, mass = series["relative_entropy"], series["mass"]
    columns = {
        "s": formatted(series["s"][rows], ".4g"),
        "H(p|p_S)": formatted(entropy[rows], ".6g"),
    }
    if "relative_entropy" in errors:
        columns["± H"] = formatted(errors["relative_entropy"][rows], ".1e")
    columns |= {
        "minimum": formatted(series["minimum"][rows], ".1e"),
        "mass error": formatted((mass / mass[:1] - 1)[rows], ".1e"),
        "boundary mass": formatted(series["boundary_mass"][rows], ".1e"),
    }
    if "kappa_boundary_mass" in series:
        at_ends = formatted(series["kappa_boundary_mass"][rows], ".1e")
        columns["at the ends of κ"] = at_ends
    return columns


def accuracy_lines(solution: Solution) -> list[str]:
    """The error of the densities and the decay rate in words, where they are known."""
    lines = []
    if solution.errors is not None and solution.saved_s.size:
        worst = float(np.max(solution.errors["density_l1"]))
        lines.append(f"estimated L1 error of the saved densities: at most {worst:.1e}")
    rate = _rate(solution)
    return lines if rate is None else [*lines, rate]


def _steps(solution: Solution) -> list[int]:
    """Return recorded steps near evenly spaced saved s, or the last that there is."""
    last = solution.series["s"].size - 1
    return [*saved_rows(solution).values()] or ([last] if last >= 0 else [])


def _rate(solution: Solution) -> str | None:
    from fpsolve.plotting.entropy import fitted_rate

    fit = fitted_rate(solution)
    if fit is None:
        return None
    start, end = fit.window
    return (
        f"H - H_box falls like exp(-λs), λ = {fit}, "
        f"fitted for s from {start:g} to {end:g}"
        + (f"; {fit.advice.rstrip('.')}" if fit.advice else "")
    )


def _summary(solution: Solution) -> list[Block]:
    lines = accuracy_lines(solution)
    said = [Paragraph(f"{line[0].upper()}{line[1:]}.") for line in lines]
    return [*outcome(solution, solution.message), *said]


def _equations(solution: Solution) -> list[Block]:
    if solution.model is None:
        return unread_model(solution.provenance)
    said = (
        "p(s, ξ, α) is the density of the end of a fibre: its deviation ξ from the "
        "nozzle's path and its direction τ(α) = (cos α, sin α), s the length laid "
        "down. Everything is dimensionless."
    )
    return [*model_equations(solution.model), Paragraph(said)]


def _parameters(solution: Solution) -> list[tuple[str, str]]:
    provenance, model = solution.provenance, solution.model
    items: list[tuple[str, str]] = []
    if model is not None:
        items += [
            ("potential", f"B = {model.potential.formula}"),
            ("noise", f"A = {model.noise:g}, A²/2 = {0.5 * model.noise**2:g}"),
            ("relaxation length", _relaxation(model)),
            ("reference curve", curve_text(model.curve)),
        ]
    items += [
        ("start", start_text(provenance, "initial")),
        ("grid", grid_text(solution.grid) + suggestion(provenance, "grid")),
        ("scheme", _scheme(solution.scheme)),
        ("step", step_text(solution) + suggestion(provenance, "ds")),
        ("saved", f"{solution.saved_s.size} densities"),
    ]
    return [item for item in items if item[1]]


def _relaxation(model: FibreModel) -> str:
    if not isinstance(model, SmoothLayDownModel):
        return ""
    length, noise = model.relaxation_length, model.curvature_noise
    return f"R = {length:g}, K = A/R = {noise:g}, K²R/2 = {model.curvature_variance:g}"


def _scheme(scheme: dict[str, Any]) -> str:
    return (
        with_options(scheme["name"], scheme["options"]) + f", order {scheme['order']}"
    )


def _numbers(solution: Solution, process: Process | None) -> list[Block]:
    columns, steps = series_columns(solution), _steps(solution)
    if not steps:
        return [Notice("Nothing was recorded.", "warning")]
    if solution.errors is not None and solution.saved_s.size:
        errors = solution.errors["density_l1"][[*saved_rows(solution)]]
        columns["L¹ error of p"] = formatted(errors, ".1e")
    if process is not None:
        lengths = 1e3 * process.to_metres(solution.series["s"][steps])
        in_mm = {"s in mm": formatted(lengths, ".4g")}
        columns = {"s": columns.pop("s"), **in_mm, **columns}
    table = Table(
        "Relative entropy, smallest value of p, relative drift of the mass and mass in "
        "the outermost cells.",
        list(columns), list(zip(*columns.values(), strict=True)),
        _entropy_note(solution),
    )  # fmt: skip
    return [table]


def _entropy_note(solution: Solution) -> str:
    model, floor = solution.model, solution.entropy_floor
    if solution.reference is not None:
        return "H is relative to the density that was given as `reference`."
    if not np.isfinite(floor):
        return "There is no equilibrium that H could be relative to."
    said = "H is relative to p_S = exp(-B)/(2πZ)"
    if model is not None and not model.has_equilibrium:
        return f"{said}, which is not stationary here: H tends to a positive constant."
    return f"{said}; on this grid it tends to H_box = {floor:.3g}."


def _accuracy(solution: Solution) -> list[Block]:
    if solution.errors is None:
        said = (
            f"{NOT_EXTRAPOLATED} A run with extrapolate = true solves with ds and "
            "ds/2, combines both, and estimates the error of every number."
        )
        return [Paragraph(said), *_laws(solution)]
    said = (
        "Errors are Richardson estimates from runs with shorter steps: those of the "
        "step. What the grid does not resolve is not in them; the mass in the "
        "outermost cells and negative values tell of it."
    )
    caption = "Largest estimated error in ds over the whole run."
    errors = {name: solution.errors[name] for name in solution.errors
              if is_extrapolated(name)}  # fmt: skip
    table = error_table(errors, caption, _NAMES)
    return [table, Paragraph(said), *_laws(solution)]


def _laws(solution: Solution) -> list[Block]:
    """What the run missed of the laws of a belt at rest, where they hold."""
    series, kept = solution.series, []
    if np.size(series.get("entropy_rise", ())):
        rise = float(np.max(series["entropy_rise"]))
        kept.append(f"H, which can only fall, rose by at most {rise:.1e}")
    if np.size(series.get("circulation_deviation", ())):
        off = float(np.max(np.abs(series["circulation_deviation"])))
        kept.append(
            f"the circulation, which decays as exp(-A²s/2), was off by at most "
            f"{off:.1e}, a lower bound of the L¹ error"
        )
    return [Paragraph(f"On a belt at rest {'; '.join(kept)}.")] if kept else []
