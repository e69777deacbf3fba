"""The page about both models of a fibre."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fpsolve.pages.blocks import Block, Facts, Notice, Paragraph, Part, Section, Table
from fpsolve.pages.figures import drawings
from fpsolve.pages.identification import parameter_rows, undetermined_notices
from fpsolve.pages.origin import provenance_part
from fpsolve.pages.settings import model_or_unread

if TYPE_CHECKING:
    from fpsolve.studies.identification.comparison import IdentificationComparison

__all__ = ["section"]


def section(found: IdentificationComparison, source: str) -> Section:
    """Return the section of a page about a comparison of identified models."""
    both = found.identifications
    equations = [
        block
        for one in both.values()
        for block in model_or_unread(one.model, one.provenance)
    ]
    warnings = [block for one in both.values() for block in undetermined_notices(one)]
    return Section("Two models of a fibre", source, [
        Part("Verdict", _verdict(found)),
        Part("Equations", equations),
        Part("Parameters", [_parameters(found), *warnings]),
        Part("Goodness of fit", [_fit(found)]),
        Part("Data and method", [Facts(_about(found))]),
        Part("Figures", drawings(found)),
        provenance_part(found.provenance, call=found.call),
    ])  # fmt: skip


def _verdict(found: IdentificationComparison) -> list[Block]:
    preference, fit, *more = found.verdict
    tone = "warning" if found.rejected() else "good"
    said = [Paragraph(sentence) for sentence in more]
    return [Notice(preference, "good"), Notice(fit, tone), *said]


def _parameters(found: IdentificationComparison) -> Table:
    rows = [
        (name, *row)
        for name, one in found.identifications.items()
        for row in parameter_rows(one)
    ]
    head = ("model", "parameter", "estimate", "standard error", "95 % interval")
    told = "In powers of the unit of length of the fibre."
    return Table(told, head, rows, words=frozenset({0, 1}))


def _fit(found: IdentificationComparison) -> Table:
    both = found.identifications
    rows = [
        (test, *(f"{one.p_values[test]:.3f}" for one in both.values()))
        for test in found.basic.p_values
    ]
    rows.append(("all together", *(f"{p:.3f}" for p in found.p_values.values())))
    told = (
        "p-values: share of a model's own fibres that are as far from their mean as "
        "the data; all together six times the smallest."
    )
    return Table(told, ("compared", *both), rows, words=frozenset({0}))


def _about(found: IdentificationComparison) -> list[tuple[str, str]]:
    fibre, k_max = found.data, found.basic.k_max
    about = [
        ("method", found.method),
        ("fibre", f"length {fibre.length:.6g}, Δs = {fibre.ds:g}"),
        ("longest lag", f"{k_max} Δs = {k_max * fibre.ds:g}"),
    ]
    for name, one in found.identifications.items():
        about += [(f"note, {name}", note) for note in one.notes]
    if found.aic is not None:
        about += [(f"AIC, {name}", f"{aic:.6g}") for name, aic in found.aic.items()]
    return about
