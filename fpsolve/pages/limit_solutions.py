"""Solutions of the two limits in numbers: equation, series, errors, figures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve.model.laydown import LayDownModel
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
from fpsolve.pages.equations import mathml, potential_equation
from fpsolve.pages.figures import drawings
from fpsolve.pages.numbers import evenly, formatted
from fpsolve.pages.origin import provenance_part
from fpsolve.pages.runs import (
    NOT_EXTRAPOLATED,
    error_table,
    outcome,
    saved_rows,
    step_text,
)
from fpsolve.pages.settings import (
    model_facts,
    process_equations,
    process_facts,
    unread_model,
)

if TYPE_CHECKING:
    from collections.abc import Mapping

    from fpsolve.model.fibre import FibreModel
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


def hydrodynamic_section(solution: HydrodynamicSolution, source: str) -> Section:
    """Return the section of a page about a solution of the limit of much noise."""
    model = None if solution.limit is None else solution.limit.model
    cells = " × ".join(map(str, solution.grid.shape))
    width1, width2 = solution.grid.half_widths
    parameter = [] if model is None else _parameters(solution.limit)
    items = [
        *model_facts(model),
        *parameter,
        ("grid", f"{cells} cells, |ξ₁| < {width1:g}, |ξ₂| < {width2:g}"),
    ]
    equations = limit_equation(model, solution.provenance)
    title = "Hydrodynamic limit of much noise"
    return _section(title, source, solution, equations, items)


def energy_section(solution: EnergySolution, source: str) -> Section:
    """Return the section of a page about a law of the energy process."""
    process, grid = solution.process, solution.grid
    signed = "signed G" if grid.signed else "|G|"
    cells = f"{grid.n_cells} cells of {signed}, g_max = {grid.g_max:.6g}"
    items = [*process_facts(process), ("grid", cells)]
    equations = process_equations(process, solution.provenance)
    title = "Law of the energy in the limit of little noise"
    return _section(title, source, solution, equations, items)


def _section(
    title: str,
    source: str,
    solution: Any,
    equations: list[Block],
    items: list[tuple[str, str]],
) -> Section:
    items = [
        *items,
        ("method", solution.method),
        ("step", step_text(solution)),
        ("saved", f"{solution.saved_s.size} densities"),
    ]
    return Section(title, source, [
        Part("Summary", outcome(solution)),
        Part("Equation", equations),
        Part("Parameters", [Facts(items)]),
        Part("Numbers at saved arclengths", _numbers(solution)),
        Part("Accuracy", _accuracy(solution)),
        Part("Figures", drawings(solution)),
        provenance_part(solution.provenance),
    ])  # fmt: skip


def _parameters(limit: Any) -> list[tuple[str, str]]:
    """ε, and the factor F of a smooth fibre."""
    small = ("ε = 1/A²", f"{limit.epsilon:g}")
    if limit.diffusivity == limit.epsilon:
        return [small]
    return [small, ("F", f"{limit.diffusivity / limit.epsilon:g}")]


def limit_equation(
    model: FibreModel | None, provenance: Mapping[str, Any]
) -> list[Block]:
    """Return the hydrodynamic limit of a model, or how one of a user's own told it."""
    factor = "" if model is None or isinstance(model, LayDownModel) else "F"
    equation: Equation = mathml(
        rf"\partial_s \mathcal{{P}} = \nabla\cdot(\varepsilon {factor}\,\nabla"
        r"\mathcal{P} + (\varepsilon\,\nabla B - v\,e_1)\,\mathcal{P})",
        f"∂ₛ𝒫 = ∇·(ε{factor}∇𝒫 + (ε∇B - v e₁) 𝒫)",
    )
    if model is None:
        return [equation, *unread_model(provenance)]
    return [equation, potential_equation(model.potential)]


def _numbers(solution: Any) -> list[Block]:
    series: Mapping[str, np.ndarray] = solution.series
    if not series["s"].size:
        return [Notice("Nothing was recorded.", "warning")]
    rows = [*saved_rows(solution).values()] or evenly(series["s"].size)
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


def _accuracy(solution: Any) -> list[Block]:
    if not solution.errors:
        return [Paragraph(NOT_EXTRAPOLATED)]
    caption = (
        "Largest estimated error in ds over the whole run; that of the grid comes in "
        "addition."
    )
    return [error_table(solution.errors, caption, {})]
