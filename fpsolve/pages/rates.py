"""A study of decay rates over noises: rates with errors, bounds, failures, figures."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from fpsolve._support.declared import declared
from fpsolve.pages.blocks import Block, Facts, Paragraph, Part, Section, Table
from fpsolve.pages.equations import fokker_planck, potential_equation
from fpsolve.pages.figures import drawings
from fpsolve.pages.numbers import with_error
from fpsolve.pages.studies import cases_blocks, entries, potential_of, versions_part

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["RATES", "rate_columns", "section"]

# Heading: (variable, its error or None, factor).
RATES: dict[str, tuple[str, str | None, float]] = {
    "∫ H ds": ("inverse_decay_rate", "inverse_decay_rate_error", 1.0),
    "spectral ∫ H ds": (
        "spectral_inverse_decay_rate", "spectral_inverse_decay_rate_error", 1.0,
    ),
    "½ rate of H": ("entropy_rate", "entropy_rate_error", 0.5),
    "spectral gap": ("gap", "gap_error", 1.0),
    "proven": ("hypocoercive_bound", None, 1.0),
}  # fmt: skip
_THEORY: dict[str, tuple[str, str | None, float]] = {
    "exact A²/2": ("small_noise_asymptote", None, 1.0),
    "Λ/A²": ("large_noise_asymptote", None, 1.0),
}
_MEANINGS = (
    ("∫ H ds", "inverse decay rate of figure 5, from a run of the density"),
    ("spectral ∫ H ds", "the same by a spectral solution"),
    ("½ rate of H", "half the rate at which the relative entropy falls in a run"),
    ("spectral gap", "slowest rate of the generator"),
    ("proven", "lower bound of the gap by hypocoercivity"),
    ("exact A²/2", "an eigenvalue for every noise, the gap when there is little"),
    ("Λ/A²", "asymptote of much noise, with the next order where it is known"),
)

_FIGURES = {
    "integral": (
        "Inverse decay rate ∫ H ds against noise, as in figure 5 of the paper.",
        "Curve of the inverse decay rate against noise",
    ),
    "rates": (
        "Decay rates of the leading modes, of the runs, and what is proven.",
        "Curves of decay rates and bounds against noise",
    ),
    "averages": (
        "Asymptotic variances against noise.",
        "Curves of asymptotic variances against noise",
    ),
}


def section(dataset: xr.Dataset, source: str) -> Section:
    """Return the section of a page about a study of rates."""
    parts = [
        Part("Summary", cases_blocks(dataset)),
        Part("Equation", _equations(dataset)),
        Part("Parameters", [Facts(_parameters(dataset))]),
        Part("Rates", _rates(dataset)),
    ]
    if "asymptotic_variance" in dataset:
        parts.append(Part("Averages along a path", [_variances(dataset)]))
    parts += [Part("Figures", drawings(dataset, _FIGURES)), versions_part(dataset)]
    return Section(
        "Rate of convergence against noise",
        source,
        [part for part in parts if part.blocks],
    )


def rate_columns(
    dataset: xr.Dataset,
    columns: Mapping[str, tuple[str, str | None, float]] = RATES,
) -> dict[str, list[str]]:
    """One cell for every noise under every heading that the dataset has."""
    found = {name: read for name, read in columns.items() if read[0] in dataset}
    cells = {"A": [f"{float(noise):.4g}" for noise in dataset["noise"]]}
    for name, read in found.items():
        cells[name] = [
            _cell(dataset.isel(noise=row), *read)
            for row in range(dataset.sizes["noise"])
        ]
    return cells


def _cell(one: xr.Dataset, name: str, error: str | None, factor: float) -> str:
    value = factor * float(one[name])
    if not math.isfinite(value):
        return "-"
    if error is None:
        return f"{value:.3g}"
    return with_error(value, factor * float(one[error]))


def _equations(dataset: xr.Dataset) -> list[Block]:
    potential = potential_of(dataset)
    if potential is None:
        return [fokker_planck(), Paragraph(f"B = {dataset.attrs['formula']}")]
    return [fokker_planck(), potential_equation(potential)]


def _parameters(dataset: xr.Dataset) -> list[tuple[str, str]]:
    about = declared(dataset.attrs)
    start = dict(about["p0"])
    return [
        ("potential", f"B = {about['formula']}, belt at rest"),
        ("noises", ", ".join(f"{float(noise):g}" for noise in dataset["noise"])),
        ("parts", ", ".join(map(str, dataset["part"].to_numpy()))),
        ("start", f"{start.pop('kind')}({entries(start)})"),
        ("tolerances", entries(about["settings"])),
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


def _variances(dataset: xr.Dataset) -> Table:
    names = [str(name) for name in dataset["function"].to_numpy()]
    rows = []
    for noise in dataset["noise"].to_numpy():
        one = dataset.sel(noise=noise)
        values, errors = one["asymptotic_variance"], one["asymptotic_variance_error"]
        cells = map(_variance, map(float, values), map(float, errors))
        rows.append([f"{float(noise):.4g}", *cells])
    return Table(
        "Asymptotic variance of the average of a function along one path, over its "
        "variance in equilibrium.",
        ("A", *(name.replace("_", " ") for name in names)), rows,
    )  # fmt: skip


def _variance(value: float, error: float) -> str:
    return with_error(value, error) if math.isfinite(value) else "-"
