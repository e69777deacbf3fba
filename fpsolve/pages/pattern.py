"""The page about the mean pattern of a web."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fpsolve.pages.blocks import Facts, Part, Section, Table
from fpsolve.pages.figures import drawings
from fpsolve.pages.origin import provenance_part

if TYPE_CHECKING:
    from fpsolve.web.pattern_result import MeanPattern

__all__ = ["section"]

# Waves that are told in each direction.
_MOST = 5


def section(pattern: MeanPattern, source: str) -> Section:
    """Return the section of a page about what a row of nozzles lays on average."""
    value, error = pattern.coefficient_of_variation()
    phases = pattern.phases
    told = phases if isinstance(phases, str) else ", ".join(f"{x:g}" for x in phases)
    items = [
        ("cell of the pattern", f"{pattern.length:g} along the belt, "
                                f"{pattern.width:g} across it"),
        ("distance of the nozzles", f"{pattern.spacing:g}"),
        ("phases", told),
        ("laid length per area", f"1/(v d) = {pattern.mean:.6g}"),
        ("CV of points", f"{value:.4g} ± {error:.1e}"),
    ]  # fmt: skip
    return Section("Mean pattern of a web", source, [
        Part("Parameters", [Facts(items)]),
        Part("Waves", [_waves(pattern)]),
        Part("Figure", drawings(pattern)),
        provenance_part(pattern.provenance, call=pattern.call),
    ])  # fmt: skip


def _waves(pattern: MeanPattern) -> Table:
    both = (
        ("bands across the belt", pattern.length,
         pattern.machine_amplitudes, pattern.machine_errors),
        ("strips along the belt", pattern.width,
         pattern.cross_amplitudes, pattern.cross_errors),
    )  # fmt: skip
    rows = [
        (words, f"{period / (j + 1):g}", f"{amplitudes[j]:.4g}", f"{errors[j]:.1e}")
        for words, period, amplitudes, errors in both
        for j in range(min(_MOST, amplitudes.size))
    ]
    told = "Amplitudes of the waves relative to the mean, and their errors."
    headings = ("waves", "period", "amplitude", "error")
    return Table(told, headings, rows, words=frozenset({0}))
