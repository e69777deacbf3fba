"""The energy process of little noise: coefficients, decay rates, figures."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fpsolve._support.declared import declared
from fpsolve.pages.blocks import Block, Facts, Paragraph, Part, Section, Table
from fpsolve.pages.equations import energy_equations
from fpsolve.pages.figures import drawings
from fpsolve.pages.numbers import formatted
from fpsolve.pages.studies import potential_equations, versions_part

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["COEFFICIENTS", "section"]

# Name of the variable: heading.
COEFFICIENTS = {
    "g": "g",
    "r_min": "r_min",
    "r_max": "r_max",
    "period": "period S",
    "variance": "σ²(g)",
    "stationary_density": "density S/∫S",
}
_FAMILIES = {"even": "of |G|", "odd": "of the sign of G"}


def section(dataset: xr.Dataset, source: str) -> Section:
    """Return the section of a page about the tables of `fpsolve energy`."""
    about = declared(dataset.attrs)
    items = [
        ("potential", f"B = {about['formula']}"),
        ("noise", f"A = {about['noise']:g}"),
        ("circle", f"r = {about['radius']:.6g}"),
        ("largest energy", f"g_max = {about['g_max']:.6g}"),
    ]
    columns = [formatted(dataset[name], ".5g") for name in COEFFICIENTS]
    coefficients = Table(
        "Orbits and the coefficients of the averaged equation, by energy.",
        list(COEFFICIENTS.values()), list(zip(*columns, strict=True)),
        "By quadrature to rounding, on a belt at rest.",
    )  # fmt: skip
    return Section("Energy process of little noise", source, [
        Part("Equation", _equations(dataset)),
        Part("Parameters", [Facts(items)]),
        Part("Coefficients", [coefficients]),
        Part("Decay rates", [_rates(dataset)]),
        Part("Figures", drawings(dataset)),
        versions_part(dataset),
    ])  # fmt: skip


def _equations(dataset: xr.Dataset) -> list[Block]:
    said = Paragraph(
        "G = r exp(-B(r)) sin β, β the angle between fibre and radius; S is the period "
        "of an orbit, J its action."
    )
    return [*energy_equations(), *potential_equations(dataset), said]


def _rates(dataset: xr.Dataset) -> Table:
    rows = []
    for family, meaning in _FAMILIES.items():
        one = dataset.sel(family=family)
        pairs = zip(*(one[name].to_numpy() for name in ("eigenvalue",
                    "eigenvalue_error")), strict=True)  # fmt: skip
        for mode, (value, error) in enumerate(pairs):
            known = (f"{value:.10g}", f"{error:.0e}") if error else ("0", "exact")
            rows.append((f"{family}, {meaning}", str(mode), *known))
    return Table(
        "Decay rates of the averaged equation (16) per unit of s.",
        ("family", "mode", "rate", "error"), rows, words=frozenset({0}),
    )  # fmt: skip
