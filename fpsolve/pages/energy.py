"""The energy process of little noise: coefficients, decay rates, figures."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fpsolve._support.declared import declared
from fpsolve.pages.blocks import Block, Facts, Paragraph, Part, Section, Table
from fpsolve.pages.equations import energy_equations, potential_equation
from fpsolve.pages.figures import drawings
from fpsolve.pages.studies import potential_of, versions_part

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
_FIGURES = {
    "orbits": (
        "Orbits of the deterministic motion and their fibres.",
        "Level curves of the energy and fibres of some energies",
    ),
    "coefficients": (
        "Period and variance against energy.",
        "Curves of period and variance against energy",
    ),
    "eigenfunctions": (
        "Slowest modes of both families.",
        "Curves of the slowest eigenfunctions against energy",
    ),
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
    columns = [[f"{float(value):.5g}" for value in dataset[name]] for name in
               COEFFICIENTS]  # fmt: skip
    coefficients = Table(
        "Orbits and the coefficients of the averaged equation, by energy.",
        list(COEFFICIENTS.values()), list(zip(*columns, strict=True)),
        "By quadrature to rounding, on a belt at rest.",
    )  # fmt: skip
    parts = [
        Part("Equation", _equations(dataset)),
        Part("Parameters", [Facts(items)]),
        Part("Coefficients", [coefficients]),
        Part("Decay rates", [_rates(dataset)]),
        Part("Figures", drawings(dataset, _FIGURES)),
        versions_part(dataset),
    ]
    return Section(
        "Energy process of little noise",
        source,
        [part for part in parts if part.blocks],
    )


def _equations(dataset: xr.Dataset) -> list[Block]:
    potential = potential_of(dataset)
    said = Paragraph(
        "G = r exp(-B(r)) sin β, β the angle between fibre and radius; S is the period "
        "of an orbit, J its action."
    )
    known = [] if potential is None else [potential_equation(potential)]
    return [*energy_equations(), *known, said]


def _rates(dataset: xr.Dataset) -> Table:
    rows = []
    for family, meaning in _FAMILIES.items():
        one = dataset.sel(family=family)
        values, errors = (
            one["eigenvalue"].to_numpy(),
            one["eigenvalue_error"].to_numpy(),
        )
        for mode, (value, error) in enumerate(zip(values, errors, strict=True)):
            known = (f"{value:.10g}", f"{error:.0e}") if error else ("0", "exact")
            rows.append((f"{family}, {meaning}", str(mode), *known))
    return Table(
        "Decay rates of the averaged equation (16) per unit of s.",
        ("family", "mode", "rate", "error"), rows, words=frozenset({0}),
    )  # fmt: skip
