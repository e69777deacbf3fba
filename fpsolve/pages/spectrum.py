"""Eigenvalues of the generator: table with errors and residuals, figure."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fpsolve._support.declared import declared
from fpsolve.pages.blocks import (
    Equation,
    Facts,
    Figure,
    Paragraph,
    Part,
    Section,
    Table,
)
from fpsolve.pages.equations import model_equations
from fpsolve.pages.figures import embedded
from fpsolve.pages.settings import curve_text
from fpsolve.pages.studies import versions_part
from fpsolve.spectral.eigen.stored import StoredSpectrum, stored_spectrum

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["section"]


def section(dataset: xr.Dataset, source: str) -> Section:
    """Return the section of a page about a spectrum."""
    spectrum = stored_spectrum(dataset)
    model, about = spectrum.model, declared(dataset.attrs)
    items = [
        ("potential", f"B = {model.potential.formula}"),
        ("noise", f"A = {model.noise:g}"),
        ("reference curve", curve_text(model.curve)),
        ("largest basis", " × ".join(map(str, about["truncation"]))),
    ]
    if spectrum.essential is not None:
        items.append(("essential spectrum", f"from {spectrum.essential:.12g} to -∞"))
    equations: list[Equation] = model_equations(model)
    gap = f"{spectrum.gap:.12g} ± {about['gap_error']:.1g}"
    said = (
        f"The spectral gap is {gap}: in the end p/p_S - 1 falls like exp(-λs) with "
        "this λ, its relative entropy with twice that."
    )
    parts = [
        Part("Summary", [Paragraph(said)]),
        Part("Equation", equations),
        Part("Parameters", [Facts(items)]),
        Part("Eigenvalues", [_table(dataset, spectrum)]),
        Part("Figure", [_figure(spectrum)]),
        versions_part(dataset),
    ]
    return Section("Eigenvalues of the generator", source, parts)


def _table(dataset: xr.Dataset, spectrum: StoredSpectrum) -> Table:
    errors, residuals = (dataset[name].to_numpy() for name in ("error", "residual"))
    rows = [
        (_complex(value), f"{error:.1e}", f"{residual:.1e}", sector)
        for value, error, residual, sector in zip(
            spectrum.eigenvalues, errors, residuals, spectrum.sectors, strict=True
        )
    ]
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


def _figure(spectrum: StoredSpectrum) -> Figure:
    from fpsolve.plotting.rates import spectrum_figure

    return embedded(
        lambda: spectrum_figure(spectrum),
        "Eigenvalues in the complex plane, by sector; dashed: where the gap ends.",
        "Eigenvalues in the complex plane",
    )
