"""Results that are mostly numbers: stationary densities, expansions, limit paths."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve.evolution.series import long_name
from fpsolve.pages.blocks import Block, Facts, Notice, Paragraph, Part, Section, Table
from fpsolve.pages.equations import mathml
from fpsolve.pages.figures import drawings
from fpsolve.pages.limit_solutions import limit_equation
from fpsolve.pages.numbers import evenly
from fpsolve.pages.origin import provenance_part
from fpsolve.pages.settings import (
    grid_text,
    model_facts,
    model_or_unread,
    process_equations,
    process_facts,
)

if TYPE_CHECKING:
    from fpsolve.density.stationary.result import SteadyState
    from fpsolve.reduced.energy.sampling import EnergyPaths
    from fpsolve.reduced.hydrodynamic.sampling import HydrodynamicPaths
    from fpsolve.spectral.evolution.smooth_solution import SmoothSpectralSolution
    from fpsolve.spectral.evolution.smooth_steady import SmoothSpectralSteadyState
    from fpsolve.spectral.evolution.solution import SpectralSolution
    from fpsolve.spectral.evolution.steady import SpectralSteadyState

__all__ = [
    "energy_paths",
    "hydrodynamic_paths",
    "smooth_spectral",
    "spectral",
    "spectral_steady_state",
    "steady_state",
]

_STATIONARY = "∂ₛp = 0: the density that every start tends to."


def steady_state(result: SteadyState, source: str) -> Section:
    """Return the section of a page about a stationary density."""
    combined = ", several steps combined" if result.extrapolated else ""
    items = [
        *model_facts(result.model),
        ("grid", grid_text(result.grid)),
        ("step", f"ds = {result.ds:.4g}{combined}"),
        ("residual", f"{result.residual:.2g} per unit of s"),
        ("evolutions", str(result.n_applications)),
    ]
    told = ", ".join(f"{name} {size:.1e}" for name, size in result.errors.items())
    said = f"Estimated L1 error of the density: {result.error:.2g} ({told})."
    tone = "good" if result.error <= 1e-4 else "warning"
    moments = _moments(result.moments(), result.moment_errors)
    return _section("Stationary density", source, result, [
        Part("Summary", [Notice(said, tone)]),
        Part("Equation", _stationary(result)),
        Part("Parameters", [Facts(items)]),
        Part("Moments", [moments]),
    ])  # fmt: skip


def spectral_steady_state(
    result: SpectralSteadyState | SmoothSpectralSteadyState, source: str
) -> Section:
    """Return the section of a page about a stationary expansion, basic or smooth."""
    degree, harmonics, *curvature = result.truncation
    curved = f", degree {curvature[0]} in κ" if curvature else ""
    items = [
        *model_facts(result.model),
        ("truncation", f"degree {degree}, {harmonics} harmonics{curved}"),
        ("residual", f"{result.residual:.2g}"),
    ]
    note = Paragraph(
        "There is no figure: an expansion is a density on whatever grid is chosen, "
        "`density(grid)`."
    )
    return _section("Stationary density by expansion", source, result, [
        Part("Equation", _stationary(result)),
        Part("Parameters", [Facts(items)]),
        Part("Moments", [_moments(result.moments, result.errors), note]),
    ])  # fmt: skip


def spectral(solution: SpectralSolution, source: str) -> Section:
    """Return the section of a page about an expansion in time."""
    degree, harmonics = np.max(solution.truncation, axis=0)
    items = [
        *model_facts(solution.model),
        ("arclengths", _span(solution.s)),
        ("largest truncation", f"degree {degree}, {harmonics} harmonics"),
        ("tolerance", f"{solution.tolerance:g}"),
    ]
    table = _series("Entropy and means with errors.", solution, _SHOWN)
    return _section("Density by expansion in time", source, solution, [
        Part("Equation", model_or_unread(solution.model, solution.provenance)),
        Part("Parameters", [Facts(items)]),
        Part("Numbers", [table]),
    ])  # fmt: skip


def smooth_spectral(solution: SmoothSpectralSolution, source: str) -> Section:
    """Return the section of a page about an expansion in time of a smooth model."""
    degree, curvature, sectors = solution.truncation
    coupled = f", {sectors} sectors beyond the first" if sectors else ""
    items = [
        *model_facts(solution.model),
        ("arclengths", _span(solution.s)),
        ("truncation", f"degrees {degree} in ξ, {curvature} in κ{coupled}"),
        ("tolerance", f"{solution.tolerance:g}"),
    ]
    table = _series("Moments with errors.", solution, _SMOOTH_SHOWN)
    return _section("Moments by expansion in time", source, solution, [
        Part("Equation", model_or_unread(solution.model, solution.provenance)),
        Part("Parameters", [Facts(items)]),
        Part("Numbers", [table]),
    ])  # fmt: skip


def _series(
    words: str,
    solution: SpectralSolution | SmoothSpectralSolution,
    shown: Mapping[str, str],
) -> Table:
    """Numbers with their errors over s."""
    rows = [
        (f"{solution.s[row]:g}", *(
            f"{solution.series[name][row]:.10g} ± {solution.errors[name][row]:.0e}"
            for name in shown
        ))
        for row in evenly(solution.s.size)
    ]  # fmt: skip
    return Table(words, ("s", *shown.values()), rows)


_SHOWN = {
    "relative_entropy": "H", "mean_xi1": "E ξ₁", "mean_xi2": "E ξ₂",
    "mean_cos_alpha": "E cos α", "mean_sin_alpha": "E sin α",
}  # fmt: skip


_SMOOTH_SHOWN = {
    "mean_xi1": "E ξ₁", "variance_xi1": "Var ξ₁", "variance_xi2": "Var ξ₂",
    "mean_cos_alpha": "E cos α", "mean_kappa": "E κ", "mean_kappa2": "E κ²",
}  # fmt: skip


def hydrodynamic_paths(paths: HydrodynamicPaths, source: str) -> Section:
    """Return the section of a page about paths of the limit of much noise."""
    step = f"ds = {paths.ds:.4g}" if paths.method != "exact" else "exact in s"
    items = [
        *model_facts(paths.model),
        ("paths", str(paths.n_paths)),
        ("arclengths", _span(paths.s)),
        ("method", f"{paths.method}, {step}"),
    ]
    (mean, mean_error), (spread, spread_error) = paths.mean(), paths.covariance()
    rows = [
        (f"{paths.s[row]:g}",
         *(f"{mean[row, k]:.5g} ± {mean_error[row, k]:.1g}" for k in (0, 1)),
         *(f"{spread[row, k, k]:.5g} ± {spread_error[row, k, k]:.1g}" for k in (0, 1)))
        for row in evenly(paths.s.size)
    ]  # fmt: skip
    headings = ("s", "E ξ₁", "E ξ₂", "Var ξ₁", "Var ξ₂")
    table = Table("Means and variances with standard errors.", headings, rows)
    return _section("Paths of the limit of much noise", source, paths, [
        Part("Equation", limit_equation(paths.model, paths.provenance)),
        Part("Parameters", [Facts(items)]),
        Part("Moments", [table]),
    ])  # fmt: skip


def energy_paths(paths: EnergyPaths, source: str) -> Section:
    """Return the section of a page about paths of the energy process."""
    n_paths = paths.g.shape[1]
    items = [
        *process_facts(paths.process),
        ("paths", str(n_paths)),
        ("arclengths", _span(paths.s)),
        ("method", f"{paths.method}, ds = {paths.ds:.4g}"),
        ("seed", str(paths.seed)),
    ]
    rows = []
    for row in evenly(paths.s.size):
        cells = [f"{paths.s[row]:g}"]
        for values in (paths.g[row], np.abs(paths.g[row])):
            error = values.std() / np.sqrt(n_paths)
            cells.append(f"{values.mean():.5g} ± {error:.1g}")
        rows.append(tuple(cells))
    table = Table("Means with standard errors.", ("s", "E G", "E |G|"), rows)
    return _section("Paths of the energy process", source, paths, [
        Part("Equation", process_equations(paths.process, paths.provenance)),
        Part("Parameters", [Facts(items)]),
        Part("Means", [table]),
    ])  # fmt: skip


def _section(title: str, source: str, result: Any, parts: list[Part]) -> Section:
    figures = Part("Figure", drawings(result))
    origin = provenance_part(result.provenance, call=result.call)
    return Section(title, source, [*parts, figures, origin])


def _stationary(result: Any) -> list[Block]:
    return [
        *model_or_unread(result.model, result.provenance),
        mathml(r"\partial_s p = 0", "∂ₛp = 0"),
        Paragraph(_STATIONARY),
    ]


def _moments(moments: Mapping[str, float], errors: Mapping[str, float]) -> Table:
    rows = [
        (long_name(name), f"{value:.10g}", f"{errors.get(name, np.nan):.1e}")
        for name, value in moments.items()
    ]
    return Table("Moments and their estimated errors.", ("moment", "value", "error"),
                 rows, words=frozenset({0}))  # fmt: skip


def _span(s: Any) -> str:
    return f"{s.size}, from {s[0]:g} to {s[-1]:g}" if s.size else "none"
