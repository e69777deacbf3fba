"""Solutions of the two limits in numbers: equation, series, errors, figures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve.pages.blocks import (
    Block,
    Equation,
    Facts,
    Notice,
    Paragraph,
    Part,
    Section,
    Table,
)
from fpsolve.pages.equations import energy_equations, mathml, potential_equation
from fpsolve.pages.figures import drawings
from fpsolve.pages.numbers import evenly, formatted
from fpsolve.pages.origin import provenance_part, status_notice
from fpsolve.pages.settings import model_facts, unread_model

if TYPE_CHECKING:
    from collections.abc import Mapping

    from fpsolve.model.laydown import LayDownModel
    from fpsolve.reduced.energy.solution import EnergySolution
    from fpsolve.reduced.hydrodynamic.solution import HydrodynamicSolution

__all__ = ["energy_section", "hydrodynamic_section", "limit_equation"]

# Name of a series: heading, format of its numbers.
_COLUMNS = {
    "relative_entropy": ("H", ".6g"),
    "entropy_dissipation": ("-dH/ds", ".3e"),
    "minimum": ("minimum", ".1e"),
    "boundary_mass": ("boundary mass", ".1e"),
    "mean_xi1": ("E ξ₁", ".4g"),
    "mean_xi2": ("E ξ₂", ".4g"),
    "variance_xi1": ("Var ξ₁", ".4g"),
    "variance_xi2": ("Var ξ₂", ".4g"),
}
_NOT_EXTRAPOLATED = "Not extrapolated: no estimate of the error in ds."


def hydrodynamic_section(solution: HydrodynamicSolution, source: str) -> Section:
    """Return the section of a page about a solution of the limit of much noise."""
    model = None if solution.limit is None else solution.limit.model
    cells = " × ".join(map(str, solution.grid.shape))
    width1, width2 = solution.grid.half_widths
    items = [
        *model_facts(model),
        *_small_parameter(model),
        ("grid", f"{cells} cells, |ξ₁| < {width1:g}, |ξ₂| < {width2:g}"),
        *_run_facts(solution),
    ]
    caption = "Plane densities at saved s; white: contours of the stationary density."
    return _section(
        "Hydrodynamic limit of much noise", source, solution,
        limit_equation(model, solution.provenance), items,
        {"hydrodynamic": (
            caption, "Maps of the density, and curves of entropy, means and spread"
        )},
    )  # fmt: skip


def energy_section(solution: EnergySolution, source: str) -> Section:
    """Return the section of a page about a law of the energy process."""
    process, grid = solution.process, solution.grid
    signed = "signed G" if grid.signed else "|G|"
    items = [
        ("grid", f"{grid.n_cells} cells of {signed}, g_max = {grid.g_max:.6g}"),
        *_run_facts(solution),
    ]
    equations: list[Any] = [*energy_equations()]
    if process is None:
        equations += unread_model(solution.provenance["process_description"])
    else:
        equations.append(potential_equation(process.potential))
        items = [("potential", f"B = {process.potential.formula}"),
                 ("noise", f"A = {process.noise:g}"), *items]  # fmt: skip
    return _section(
        "Law of the energy in the limit of little noise", source, solution, equations,
        items,
        {"law": ("Law of the energy at saved s; dashed: the stationary law.",
                 "Curves of the density of the energy, and of its entropy")},
    )  # fmt: skip


def _section(
    title: str,
    source: str,
    solution: Any,
    equations: list[Any],
    items: list[tuple[str, str]],
    figure: Mapping[str, tuple[str, str]],
) -> Section:
    parts = [
        Part("Summary", _summary(solution)),
        Part("Equation", equations),
        Part("Parameters", [Facts(items)]),
        Part("Numbers at saved arclengths", _numbers(solution)),
        Part("Accuracy", _accuracy(solution)),
        Part("Figures", drawings(solution, figure)),
        provenance_part(solution.provenance),
    ]
    return Section(title, source, [part for part in parts if part.blocks])


def _small_parameter(model: LayDownModel | None) -> list[tuple[str, str]]:
    return [] if model is None else [("ε = 1/A²", f"{1.0 / model.noise**2:g}")]


def _run_facts(solution: Any) -> list[tuple[str, str]]:
    s = solution.series["s"]
    reached = f", s from {s[0]:g} to {s[-1]:g}" if s.size else ""
    also = " and ds/2, extrapolated" if solution.errors else ""
    return [
        ("method", solution.method),
        ("step", f"ds = {solution.ds:g}{also}{reached}"),
        ("saved", f"{solution.saved_s.size} densities"),
    ]


def limit_equation(
    model: LayDownModel | None, provenance: Mapping[str, Any]
) -> list[Block]:
    """Return the hydrodynamic limit of a model, or how one of a user's own told it."""
    equation: Equation = mathml(
        r"\partial_s \mathcal{P} = \nabla\cdot(\varepsilon\,\nabla\mathcal{P}"
        r" + (\varepsilon\,\nabla B - v\,e_1)\,\mathcal{P})",
        "∂ₛ𝒫 = ∇·(ε∇𝒫 + (ε∇B - v e₁) 𝒫)",
    )
    if model is None:
        return [equation, *unread_model(provenance)]
    return [equation, potential_equation(model.potential)]


def _summary(solution: Any) -> list[Block]:
    blocks: list[Block] = [status_notice(solution.status, "")]
    if not solution.errors:
        blocks.append(Notice(_NOT_EXTRAPOLATED, "warning"))
    return blocks


def _numbers(solution: Any) -> list[Block]:
    series: Mapping[str, np.ndarray] = solution.series
    if not series["s"].size:
        return [Notice("Nothing was recorded.", "warning")]
    rows = _rows(series["s"], solution.saved_s)
    columns = {"s": formatted(series["s"][rows], ".4g")}
    for name, (heading, form) in _COLUMNS.items():
        if name in series:
            columns[heading] = formatted(series[name][rows], form)
    table = Table(
        "Relative entropy to the stationary law, its dissipation, and what else was "
        "recorded.",
        list(columns), list(zip(*columns.values(), strict=True)),
    )  # fmt: skip
    return [table]


def _rows(s: np.ndarray, saved: np.ndarray) -> list[int]:
    if not saved.size:
        return evenly(s.size)
    return [int(np.argmin(np.abs(s - saved[place]))) for place in evenly(saved.size)]


def _accuracy(solution: Any) -> list[Block]:
    if not solution.errors:
        return [Paragraph(_NOT_EXTRAPOLATED)]
    from fpsolve.evolution.series import long_name

    rows = [
        (long_name(name), f"{float(np.max(values)):.1e}")
        for name, values in solution.errors.items()
        if np.size(values) and np.isfinite(values).all()
    ]
    table = Table(
        "Largest estimated error in ds over the whole run; that of the grid comes in "
        "addition.",
        ("quantity", "at most"), rows, words=frozenset({0}),
    )  # fmt: skip
    return [table]
