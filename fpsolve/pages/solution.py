"""A density p(s) in numbers: what was solved, series at saved s, errors, figures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve.pages.blocks import (
    Block,
    Equation,
    Facts,
    Figure,
    Notice,
    Paragraph,
    Part,
    Section,
    Table,
)
from fpsolve.pages.figures import embedded
from fpsolve.pages.numbers import evenly, formatted
from fpsolve.pages.origin import provenance_part, status_notice, suggestion
from fpsolve.pages.settings import (
    curve_text,
    grid_text,
    start_text,
    unread_model,
    with_options,
)
from fpsolve.pages.units import process_of, units_part

if TYPE_CHECKING:
    from fpsolve.density.solution import Solution
    from fpsolve.model.process import Process

__all__ = ["accuracy_lines", "section", "series_columns"]

# Name of a figure: caption, and what is seen on it.
_FIGURES = {
    "overview": (
        "The run on one page: ∫ p dα at four saved s, with the contours that enclose "
        "50 and 95 % of the equilibrium in white; relative entropy; law of the angle; "
        "spread.",
        "Maps of the density over the plane, and curves of entropy, angle and spread",
    ),
    "marginals": (
        "∫ p dα at saved s; white: contours of the equilibrium.",
        "Maps of the density over the plane at saved arclengths",
    ),
    "angle": ("∫ p dξ at saved s.", "Law of the angle at saved arclengths"),
    "entropy": (
        "Relative entropy above its value on the grid, and its dissipation.",
        "Relative entropy and dissipation against arclength, logarithmic",
    ),
    "moments": (
        "Means, variances and the mean direction.",
        "Moments of the density against arclength",
    ),
}

_NAMES = {"density_l1": "saved densities p, in the L¹ norm"}


def section(solution: Solution, source: str) -> Section:
    """Return the section of a page about a solution."""
    process = process_of(solution.provenance)
    parts = [
        Part("Summary", _summary(solution)),
        Part("Equation", _equations(solution)),
        Part("Parameters", [Facts(_parameters(solution))]),
    ]
    if process is not None:
        parts.append(units_part(process))
    parts += [
        Part("Numbers at saved arclengths", _numbers(solution, process)),
        Part("Accuracy", _accuracy(solution)),
        Part("Figures", _figures(solution)),
        provenance_part(solution.provenance, call=solution.call),
    ]
    return Section("Density of a run", source, [part for part in parts if part.blocks])


def series_columns(solution: Solution) -> dict[str, list[str]]:
    """Entropy, minimum, mass error and boundary mass near evenly spaced saved s."""
    rows = [step for step, _ in _rows(solution)]
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
    return columns


def accuracy_lines(solution: Solution) -> list[str]:
    """The error of the densities and the decay rate in words, where they are known."""
    lines = []
    if solution.errors is not None and solution.saved_s.size:
        worst = float(np.max(solution.errors["density_l1"]))
        lines.append(f"estimated L1 error of the saved densities: at most {worst:.1e}")
    rate = _rate(solution)
    return lines if rate is None else [*lines, rate]


def _rows(solution: Solution) -> list[tuple[int, int | None]]:
    """Return recorded steps near evenly spaced saved s, with the number of each."""
    s, saved = solution.series["s"], solution.saved_s
    if not saved.size:
        return [(s.size - 1, None)] if s.size else []
    return [
        (int(np.argmin(np.abs(s - saved[place]))), place)
        for place in evenly(saved.size)
    ]


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
    blocks: list[Block] = [status_notice(solution.status, solution.message)]
    if solution.errors is None:
        blocks.append(
            Notice("Not extrapolated: no estimate of the error in ds.", "warning")
        )
    lines = accuracy_lines(solution)
    return blocks + [Paragraph(f"{line[0].upper()}{line[1:]}.") for line in lines]


def _equations(solution: Solution) -> list[Block]:
    if solution.model is None:
        return unread_model(solution.provenance)
    from fpsolve.pages.equations import model_equations

    said = (
        "p(s, ξ, α) is the density of the end of a fibre: its deviation ξ from the "
        "nozzle's path and its direction τ(α) = (cos α, sin α), s the length laid "
        "down. Everything is dimensionless."
    )
    equations: list[Equation] = model_equations(solution.model)
    return [*equations, Paragraph(said)]


def _parameters(solution: Solution) -> list[tuple[str, str]]:
    provenance, model = solution.provenance, solution.model
    items: list[tuple[str, str]] = []
    if model is not None:
        items += [
            ("potential", f"B = {model.potential.formula}"),
            ("noise", f"A = {model.noise:g}, A²/2 = {model.diffusivity:g}"),
            ("reference curve", curve_text(model.curve)),
        ]
    items += [
        ("start", start_text(provenance, "initial")),
        ("grid", grid_text(solution.grid) + suggestion(provenance, "grid")),
        ("scheme", _scheme(solution.scheme)),
        ("step", _step(solution) + suggestion(provenance, "ds")),
        ("saved", f"{solution.saved_s.size} densities"),
    ]
    return [item for item in items if item[1]]


def _scheme(scheme: dict[str, Any]) -> str:
    return (
        with_options(scheme["name"], scheme["options"]) + f", order {scheme['order']}"
    )


def _step(solution: Solution) -> str:
    s = solution.series["s"]
    reached = f", s from {s[0]:g} to {s[-1]:g}" if s.size else ""
    also = " and ds/2, extrapolated" if solution.errors is not None else ""
    return f"ds = {solution.ds:g}{also}{reached}"


def _numbers(solution: Solution, process: Process | None) -> list[Block]:
    columns = series_columns(solution)
    rows = _rows(solution)
    if not rows:
        return [Notice("Nothing was recorded.", "warning")]
    steps = [step for step, _ in rows]
    if solution.errors is not None and solution.saved_s.size:
        places = [place for _, place in rows if place is not None]
        errors = solution.errors["density_l1"][places]
        columns["L¹ error of p"] = formatted(errors, ".1e")
    if process is not None:
        lengths = 1e3 * process.to_metres(solution.series["s"][steps])
        columns = {
            "s": columns.pop("s"),
            "s in mm": formatted(lengths, ".4g"),
        } | columns
    table = Table(
        "Relative entropy, smallest value of p, relative drift of the mass and mass in "
        "the outermost cells.",
        list(columns), list(zip(*columns.values(), strict=True)),
        _entropy_note(solution),
    )  # fmt: skip
    return [table]


def _entropy_note(solution: Solution) -> str:
    model, floor = solution.model, solution.entropy_floor
    if not np.isfinite(floor):
        return "There is no equilibrium that H could be relative to."
    said = "H is relative to p_S = exp(-B)/(2πZ)"
    if model is not None and not model.has_equilibrium:
        return f"{said}, which is not stationary here: H tends to a positive constant."
    return f"{said}; on this grid it tends to H_box = {floor:.3g}."


def _accuracy(solution: Solution) -> list[Block]:
    if solution.errors is None:
        said = (
            "Not extrapolated: no estimate of the error in ds. A run with extrapolate "
            "= true solves with ds and ds/2, combines both, and estimates the error "
            "of every number."
        )
        return [Paragraph(said), *_laws(solution)]
    said = (
        "Errors are Richardson estimates from the runs with ds and ds/2: those of the "
        "step. What the grid does not resolve is not in them; the mass in the "
        "outermost cells and negative values tell of it."
    )
    return [_error_table(solution), Paragraph(said), *_laws(solution)]


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


def _error_table(solution: Solution) -> Table:
    from fpsolve.evolution.series import is_extrapolated, long_name

    errors = solution.errors or {}
    rows = [
        (_NAMES.get(name) or long_name(name), f"{float(np.max(values)):.1e}")
        for name, values in errors.items()
        if np.size(values) and np.isfinite(values).all() and is_extrapolated(name)
    ]
    return Table(
        "Largest estimated error in ds over the whole run.", ("quantity", "at most"),
        rows, words=frozenset({0}),
    )  # fmt: skip


def _figures(solution: Solution) -> list[Figure]:
    from fpsolve.plotting.files import possible_figures

    return [
        embedded(lambda draw=draw: draw(solution), *_FIGURES[name])  # type: ignore[misc]
        for name, draw in possible_figures(solution).items()
    ]
