"""Studies of the limits of much and of little noise: distances, orders, figures."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fpsolve._support.declared import declared
from fpsolve.pages.blocks import Block, Equation, Facts, Paragraph, Part, Section, Table
from fpsolve.pages.equations import energy_equations, fokker_planck, mathml
from fpsolve.pages.figures import drawings
from fpsolve.pages.numbers import assigned
from fpsolve.pages.studies import (
    cases_blocks,
    listed,
    potential_equations,
    start_of,
    versions_part,
)

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "large_rows",
    "large_section",
    "small_rows",
    "small_section",
    "spectrum_section",
    "table_of",
]

_LARGE_NOTE = (
    "Orders are in ε = 1/A²; *: below three times its numerical error, so that the "
    "solver cannot tell it from zero. A dash: not known."
)
_SMALL_NOTE = (
    "± cells: error of the cells of the grid, at most. Orders are in A². Paths: "
    "distance by paths, and what chance alone gives. A dash: not known."
)


def large_section(dataset: xr.Dataset, source: str) -> Section:
    """Return the section of a page about the limit of much noise."""
    about = declared(dataset.attrs)
    items = [
        ("potential", f"B = {about['formula']}"),
        ("noises", listed(dataset["noise"])),
        ("slow length s/A²", f"{about['slow_length']:g}"),
        ("belt speed", f"v = {about['belt_speed_scale']:g}/A², or "
                       f"v = {about['fixed_speed']:g} where it is fixed"),
        ("start", start_of(about["p0"])),
        ("resolution", "quick" if about["quick"] else "full"),
    ]  # fmt: skip
    meanings = (
        str(meaning).replace("e^{−B}", "e⁻ᴮ")
        for meaning in dataset["meaning"].to_numpy()
    )
    rows = [
        {**row, "quantity": meaning}
        for row, meaning in zip(large_rows(dataset), meanings, strict=True)
    ]
    table = table_of(
        "Distance of the full equation from its limit at the same slow length.",
        rows, _LARGE_NOTE, words=frozenset({0}),
    )  # fmt: skip
    limit = mathml(
        r"\partial_\sigma \mathcal{P} = \nabla\cdot(\nabla\mathcal{P}"
        r" + (\nabla B - w\,e_1)\,\mathcal{P})",
        "∂_σ𝒫 = ∇·(∇𝒫 + (∇B - w e₁) 𝒫)",
    )
    scaling = mathml(
        r"\sigma = \varepsilon s,\quad v = \varepsilon w,\quad \varepsilon = A^{-2}",
        "σ = εs, v = εw, ε = 1/A²",
    )
    return _section(
        "Limit of much noise", source, dataset, [limit, scaling], items, [table]
    )


def small_section(dataset: xr.Dataset, source: str) -> Section:
    """Return the section of a page about the limit of little noise."""
    about = declared(dataset.attrs)
    items = [
        ("potential", f"B = {about['formula']}"),
        ("noises", listed(dataset["noise"])),
        ("belt speeds v/A²", listed(dataset["belt_speed_scale"])),
        ("settings", assigned(about["options"], ".4g")),
    ]  # fmt: skip
    table = table_of(
        "Distance of the law of the energy G from that of the averaged equation (16).",
        small_rows(dataset), _SMALL_NOTE,
    )  # fmt: skip
    limit = energy_equations()
    said = Paragraph(
        "G = r exp(-B(r)) sin β, β the angle between fibre and radius, changes slowly "
        "when there is little noise; averaged over the fast rotation it is a diffusion."
    )
    return _section(
        "Limit of little noise", source, dataset, limit, items, [said, table]
    )


def spectrum_section(dataset: xr.Dataset, source: str) -> Section:
    """Return the section of a page about spectra in the limit of little noise."""
    about = declared(dataset.attrs)
    items = [
        ("potential", f"B = {about['formula']}"),
        ("noises", listed(dataset["noise"])),
        ("tolerance", f"{about['tolerance']:g}"),
    ]
    table = table_of(
        "Slowest real rate of the sector M = 0 over A², even and odd under reflection.",
        _rate_rows(dataset),
        "Limit: the rate of |G| (even) and of signed G (odd) in the energy process. A "
        "dash: no basis that fits resolves it.",
        words=frozenset({0}),
    )  # fmt: skip
    return Section("Spectrum in the limit of little noise", source, [
        Part("Equation and its limit", [
            fokker_planck(), *potential_equations(dataset), *energy_equations()
        ]),
        Part("Parameters", [Facts(items)]),
        Part("Rates", [table]),
        Part("Figure", drawings(dataset)),
        versions_part(dataset),
    ])  # fmt: skip


def _rate_rows(dataset: xr.Dataset) -> list[dict[str, str]]:
    rows = []
    for family in dataset["family"].to_numpy():
        one = dataset.sel(family=family)
        row = {"family": str(family)}
        columns = (one[name].to_numpy() for name in ("noise", "rate", "rate_error"))
        for noise, rate, error in zip(*columns, strict=True):
            known = math.isfinite(rate)
            row[f"A = {noise:g}"] = f"{rate:.6g} ± {error:.1g}" if known else "-"
        row["limit"] = f"{float(one['limit']):.6g} ± {float(one['limit_error']):.1g}"
        rows.append(row)
    return rows


def large_rows(
    dataset: xr.Dataset, over: str = "noise", symbol: str = "A"
) -> list[dict[str, str]]:
    """One row for every quantity: distances by noise, order derived and fitted."""
    rows, last = [], ""
    for quantity in dataset["quantity"].to_numpy():
        one = dataset.sel(quantity=quantity)
        part, measure = str(quantity).split("/")
        row = {"quantity": f"{part}:\n  {measure}" if part != last else f"  {measure}"}
        last = part
        names = (over, "distance", "distance_error")
        columns = (one[name].to_numpy() for name in names)
        for noise, distance, error in zip(*columns, strict=True):
            mark = "*" if distance < 3 * error else ""
            row[f"{symbol} = {noise:g}"] = _number(distance) + mark
        row["derived"] = _number(float(one["expected_order"]))
        row["fitted"] = _number(float(one["fitted_order"]))
        rows.append(row)
    return rows


def small_rows(dataset: xr.Dataset) -> list[dict[str, str]]:
    """One row for every belt speed and noise."""
    names = {
        "distance": "distance", "± cells": "distance_error",
        "order": "observed_order", "E G": "mean", "exact at rest": "exact_mean",
        "paths": "paths_distance", "chance": "paths_distance_by_chance",
    }  # fmt: skip
    rows = []
    for w in dataset["belt_speed_scale"].to_numpy():
        for noise in dataset["noise"].to_numpy():
            one = dataset.sel(belt_speed_scale=w, noise=noise)
            row = {"v/A²": f"{w:g}", "A": f"{noise:g}"}
            rows.append(
                row | {key: _number(float(one[at])) for key, at in names.items()}
            )
    return rows


def _number(value: float) -> str:
    return f"{value:.2g}" if math.isfinite(value) else "-"


def table_of(
    caption: str,
    rows: list[dict[str, str]],
    note: str,
    words: frozenset[int] = frozenset(),
) -> Table:
    """The table of rows that share their keys, which are the headings."""
    headings = list(rows[0]) if rows else []
    return Table(caption, headings, [list(row.values()) for row in rows], note, words)


def _section(
    title: str,
    source: str,
    dataset: xr.Dataset,
    limit: list[Equation],
    items: list[tuple[str, str]],
    distances: list[Block],
) -> Section:
    return Section(title, source, [
        Part("Summary", cases_blocks(dataset)),
        Part("Equation and its limit", [
            fokker_planck(), *potential_equations(dataset), *limit
        ]),
        Part("Parameters", [Facts(items)]),
        Part("Distances", distances),
        Part("Figures", drawings(dataset)),
        versions_part(dataset),
    ])  # fmt: skip
