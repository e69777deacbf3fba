"""The page about nozzles that were designed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fpsolve.pages.blocks import Block, Facts, Notice, Part, Section, Table
from fpsolve.pages.equations import model_equations
from fpsolve.pages.figures import drawings
from fpsolve.pages.origin import provenance_part

if TYPE_CHECKING:
    from fpsolve.studies.nozzles.result import NozzleDesign

__all__ = ["section"]


def section(design: NozzleDesign, source: str) -> Section:
    """Return the section of a page about designed nozzles."""
    phases = design.phases
    told = phases if isinstance(phases, str) else ", ".join(f"{x:g}" for x in phases)
    items = [
        ("aim", "the mean of CV² of the pattern over the zones is smallest"),
        ("distance of the nozzles", f"{design.spacing:g}"),
        ("phases", told),
        ("patterns", f"{design.n_scanned} of the scan, {len(design.points)} in all, "
                     f"{design.n_unknown} not known to the tolerance"),
    ]  # fmt: skip
    equations = [] if design.model is None else [*model_equations(design.model)]
    return Section("Design of moving nozzles", source, [
        Part("Equation", equations),
        Part("Summary", [_held(design), Facts(items)]),
        Part("Nozzles", [_parameters(design)]),
        Part("Homogeneity", [_zones(design)]),
        Part("Figure", drawings(design)),
        provenance_part(design.provenance, call=design.call),
    ])  # fmt: skip


def _held(design: NozzleDesign) -> Block:
    if not design.active:
        return Notice("No bound holds the optimum.", "good")
    return Notice(f"Held by {', '.join(design.active)}.", "warning")


def _parameters(design: NozzleDesign) -> Table:
    rows = [
        (name, f"{value:.5g}", f"{low:.4g} to {high:.4g}", f"{first:g} to {last:g}")
        for name, value, low, high, first, last in zip(
            design.names, design.values, *design.ranges, design.lower, design.upper,
            strict=True,
        )
    ]  # fmt: skip
    headings = ("parameter", "optimum", "may be", "bounds")
    told = "Free numbers of the nozzle, and what the errors do not tell from them."
    return Table(told, headings, rows, words=frozenset({0}))


def _zones(design: NozzleDesign) -> Table:
    rows = []
    for n, zone in enumerate(design.zones):
        laid = (
            f"{design.laid_pattern[n]:.3g} ± {design.laid_pattern_errors[n]:.1e}",
            f"{design.z[n]:.2f}", f"{design.laid[n]:.4g} ± {design.laid_errors[n]:.1e}",
        ) if design.n_webs else ("–",) * 3  # fmt: skip
        rows.append((
            f"{zone:g}", f"{design.pattern_cv[n]:.4g}",
            f"{design.pattern_errors[n]:.1e}", *laid,
        ))  # fmt: skip
    headings = ("side", "CV", "error", "laid, CV² of the pattern", "z", "laid, CV²")
    told = f"Variation of square zones; {design.n_webs} webs laid of each."
    return Table(told, headings, rows)
