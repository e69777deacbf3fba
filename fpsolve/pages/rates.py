"""A study of decay rates over noises: rates with errors, bounds, failures, figures."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from fpsolve._support.declared import declared
from fpsolve.pages.blocks import Block, Facts, Paragraph, Part, Section, Table
from fpsolve.pages.equations import fokker_planck
from fpsolve.pages.figures import drawings
from fpsolve.pages.numbers import assigned, formatted, with_error
from fpsolve.pages.studies import (
    cases_blocks,
    listed,
    potential_equations,
    start_of,
    versions_part,
)

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["RATES", "rate_columns", "section"]

# Heading: variable; its error is in `..._error`, unless it is a bound.
RATES = {
    "∫ H ds": "inverse_decay_rate",
    "spectral ∫ H ds": "spectral_inverse_decay_rate",
    "½ rate of H": "entropy_rate",
    "spectral gap": "gap",
    "proven": "hypocoercive_bound",
}
_THEORY = {"exact A²/2": "small_noise_asymptote", "Λ/A²": "large_noise_asymptote"}
_HALVED = "entropy_rate"
# Bounds and asymptotes, which have no error; what is measured is not shown without one.
_EXACT = {"hypocoercive_bound", *_THEORY.values()}
_MEANINGS = (
    ("∫ H ds", "inverse decay rate of figure 5, from a run of the density"),
    ("spectral ∫ H ds", "the same by a spectral solution"),
    ("½ rate of H", "half the rate at which the relative entropy falls in a run"),
    ("spectral gap", "slowest rate of the generator"),
    ("proven", "lower bound of the gap by hypocoercivity"),
    ("exact A²/2", "an eigenvalue for every noise, the gap when there is little"),
    ("Λ/A²", "asymptote of much noise, with the next order where it is known"),
)


def section(dataset: xr.Dataset, source: str) -> Section:
    """Return the section of a page about a study of rates."""
    said = [Paragraph(f"B = {dataset.attrs['formula']}")]
    return Section("Rate of convergence against noise", source, [
        Part("Summary", cases_blocks(dataset)),
        Part("Equation", [fokker_planck(), *(potential_equations(dataset) or said)]),
        Part("Parameters", [Facts(_parameters(dataset))]),
        Part("Rates", _rates(dataset)),
        Part("Averages along a path", _variances(dataset)),
        Part("Figures", drawings(dataset)),
        versions_part(dataset),
    ])  # fmt: skip


def rate_columns(
    dataset: xr.Dataset, columns: Mapping[str, str] = RATES
) -> dict[str, list[str]]:
    """One cell for every noise under every heading that the dataset has."""
    cells = {"A": formatted(dataset["noise"], ".4g")}
    for heading, name in columns.items():
        if name in dataset:
            factor = 0.5 if name == _HALVED else 1.0
            cells[heading] = _cells(dataset, name, factor)
    return cells


def _cells(dataset: xr.Dataset, name: str, factor: float = 1.0) -> list[str]:
    """Numbers with their errors, but for bounds; a dash where nothing is known."""
    values = (factor * dataset[name]).to_numpy().tolist()
    if name in _EXACT:
        return [f"{value:.3g}" if math.isfinite(value) else "-" for value in values]
    errors = (factor * dataset[f"{name}_error"]).to_numpy().tolist()
    return [
        with_error(value, error) if math.isfinite(value) else "-"
        for value, error in zip(values, errors, strict=True)
    ]


def _parameters(dataset: xr.Dataset) -> list[tuple[str, str]]:
    about = declared(dataset.attrs)
    return [
        ("potential", f"B = {about['formula']}, belt at rest"),
        ("noises", listed(dataset["noise"])),
        ("parts", ", ".join(map(str, dataset["part"].to_numpy()))),
        ("start", start_of(about["p0"])),
        ("tolerances", assigned(about["settings"], ".4g")),
        ("resolution", "quick" if about["quick"] else "full"),
    ]


def _rates(dataset: xr.Dataset) -> list[Block]:
    cells = rate_columns(dataset, RATES | _THEORY)
    cells = {name: column for name, column in cells.items() if set(column) != {"-"}}
    table = Table(
        "Integral of the relative entropy, and rates with bounds and asymptotes.",
        list(cells), list(zip(*cells.values(), strict=True)),
        "In parentheses: the error in units of the last digit; it covers step, grid "
        "and truncation. A dash: not computed, or nothing known.",
    )  # fmt: skip
    return [table, Facts([item for item in _MEANINGS if item[0] in cells])]


def _variances(dataset: xr.Dataset) -> list[Block]:
    if "asymptotic_variance" not in dataset:
        return []
    columns = {"A": formatted(dataset["noise"], ".4g")}
    for name in map(str, dataset["function"].to_numpy()):
        one = dataset.sel(function=name)
        columns[name.replace("_", " ")] = _cells(one, "asymptotic_variance")
    table = Table(
        "Asymptotic variance of the average of a function along one path, over its "
        "variance in equilibrium.",
        list(columns), list(zip(*columns.values(), strict=True)),
    )  # fmt: skip
    return [table]
