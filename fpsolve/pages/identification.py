"""The page about parameters that were identified from a fibre."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fpsolve.pages.blocks import Block, Facts, Notice, Part, Section, Table
from fpsolve.pages.figures import drawings
from fpsolve.pages.origin import provenance_part
from fpsolve.pages.settings import model_or_unread

if TYPE_CHECKING:
    from fpsolve.studies.identification.identification import Identification

__all__ = ["parameter_rows", "section", "undetermined_notices"]

SYMBOLS = {"sigma1": "σ₁", "sigma2": "σ₂", "noise": "A", "curvature_noise": "K"}
# A p-value below it is evidence against the model.
UNLIKELY = 0.02


def section(found: Identification, source: str) -> Section:
    """Return the section of a page about an identification."""
    about = [
        ("method", found.method),
        ("fibre", f"length {found.data.length:.6g}, Δs = {found.data.ds:g}"),
        ("longest lag", f"{found.k_max} Δs = {found.k_max * found.data.ds:g}"),
        *[("note", note) for note in found.notes],
    ]
    if found.aic is not None:
        about.append(("AIC", f"{found.aic:.6g}"))
    return Section("Identified parameters", source, [
        Part("Equation", model_or_unread(found.model, found.provenance)),
        Part("Parameters", [_parameters(found), *undetermined_notices(found)]),
        Part("Goodness of fit", [_fit(found)]),
        Part("Data and method", [Facts(about)]),
        Part("Figures", drawings(found)),
        provenance_part(found.provenance, call=found.call),
    ])  # fmt: skip


def parameter_rows(found: Identification) -> list[tuple[str, ...]]:
    """Symbol, estimate, standard error and 95 % interval of every parameter."""
    errors, intervals = found.standard_errors, found.interval(0.95)
    return [
        (SYMBOLS[name], f"{value:.5g}", f"{errors[name]:.2g}",
         f"{intervals[name][0]:.4g} to {intervals[name][1]:.4g}")
        for name, value in found.parameters.items()
    ]  # fmt: skip


def _parameters(found: Identification) -> Table:
    head = ("parameter", "estimate", "standard error", "95 % interval")
    return Table(
        "In powers of the unit of length of the fibre.", head, parameter_rows(found)
    )


def undetermined_notices(found: Identification) -> list[Block]:
    """Warnings of what the fibre does not determine."""
    return [
        Notice(f"{SYMBOLS[name]} is not determined: {why}.", "warning")
        for name, why in found.undetermined.items()
    ]


def _fit(found: Identification) -> Table:
    rows = [
        (name, f"{p:.3f}", "no" if p < UNLIKELY else "yes")
        for name, p in found.p_values.items()
    ]
    return Table(
        "Whether fibres of the model are like the data: share of them as far from "
        "their mean.", ("compared", "p-value", "like the data"), rows,
        words=frozenset({0, 2}),
    )  # fmt: skip
