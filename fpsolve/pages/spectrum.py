"""Eigenvalues of the generator: table with errors and residuals, figure."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.pages.blocks import Facts, Paragraph, Part, Section, Table
from fpsolve.pages.figures import drawings
from fpsolve.pages.origin import provenance_part
from fpsolve.pages.settings import model_facts, model_or_unread

if TYPE_CHECKING:
    from fpsolve.spectral.eigen.spectrum import Spectrum

__all__ = ["section"]


def section(spectrum: Spectrum, source: str) -> Section:
    """Return the section of a page about a spectrum."""
    items = [
        *model_facts(spectrum.model),
        (
            "largest basis",
            " × ".join(str(size) for size in spectrum.truncation if size),
        ),
    ]
    if spectrum.essential is not None:
        items.append(("essential spectrum", f"from {spectrum.essential:.12g} to -∞"))
    gap = f"{spectrum.gap:.12g} ± {spectrum.gap_error:.1g}"
    smooth = isinstance(spectrum.model, SmoothLayDownModel)
    distance = "the distance to the stationary density" if smooth else "p/p_S - 1"
    said = (
        f"The spectral gap is {gap}: in the end {distance} falls like exp(-λs) with "
        "this λ, the relative entropy with twice that."
    )
    return Section("Eigenvalues of the generator", source, [
        Part("Summary", [Paragraph(said)]),
        Part("Equation", model_or_unread(spectrum.model, spectrum.provenance)),
        Part("Parameters", [Facts(items)]),
        Part("Eigenvalues", [_table(spectrum)]),
        Part("Figure", drawings(spectrum)),
        provenance_part(spectrum.provenance, call=spectrum.call),
    ])  # fmt: skip


def _table(spectrum: Spectrum) -> Table:
    rows = [
        (_complex(value), f"{error:.1e}", f"{residual:.1e}", str(sector))
        for value, error, residual, sector in zip(
            spectrum.eigenvalues, spectrum.errors, spectrum.residuals,
            spectrum.sectors, strict=True,
        )
    ]  # fmt: skip
    return Table(
        "The slowest modes without the 0 of the constants.",
        ("λ", "error", "residual", "sector"), rows,
        "Error: change from the truncation before plus rounding. Residual: "
        "‖Lf - λf‖/‖f‖ in the next larger basis. A sector ±M has every eigenvalue "
        "twice and lists it once.",
        words=frozenset({3}),
    )  # fmt: skip


def _complex(value: complex) -> str:
    imaginary = f" {'-' if value.imag < 0 else '+'} {abs(value.imag):.11g}i"
    return f"{value.real:.12g}" + (imaginary if value.imag else "")
