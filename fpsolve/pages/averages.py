"""Averages along paths: errors at the end, asymptotic variances, figure."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fpsolve._support.declared import declared
from fpsolve.pages.blocks import Block, Facts, Paragraph, Part, Section, Table
from fpsolve.pages.equations import fokker_planck, mathml
from fpsolve.pages.figures import drawings
from fpsolve.pages.numbers import grouped
from fpsolve.pages.studies import listed, potential_equations, versions_part

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["section"]


def section(dataset: xr.Dataset, source: str) -> Section:
    """Return the section of a page about averages along paths."""
    about = declared(dataset.attrs)
    s = dataset["s"].to_numpy()
    items = [
        ("potential", f"B = {about['formula']}, belt at rest"),
        ("noises", listed(dataset["noise"])),
        ("paths", f"{grouped(about['n_paths'])} of each noise"),
        ("arclengths", f"{s.size}, from {s[0]:g} to {s[-1]:g}"),
    ]
    if "ds" in dataset:
        items.append(("step ds", listed(dataset["ds"], ".4g")))
    nothing = Paragraph("There is no figure: a curve needs two noises.")
    return Section("Averages along paths", source, [
        Part("Equation", _equations(dataset)),
        Part("Parameters", [Facts(items)]),
        Part("Averages", [_said(), _table(dataset)]),
        Part("Figure", drawings(dataset) or [nothing]),
        versions_part(dataset),
    ])  # fmt: skip


def _equations(dataset: xr.Dataset) -> list[Block]:
    error = mathml(
        r"e(s) = \left\| \frac{1}{s}\int_0^s f\,dt - E f \right\|",
        "e(s) = ‖s⁻¹∫₀ˢ f dt − E f‖",
    )
    return [fokker_planck(), *potential_equations(dataset), error]


def _said() -> Paragraph:
    return Paragraph(
        "Paths start from the equilibrium; E f and the deviation of f are by "
        "quadrature. Errors are in units of that deviation, variances in units of its "
        "square; what follows ± is one standard error."
    )


def _table(dataset: xr.Dataset) -> Table:
    rows = []
    for noise in range(dataset.sizes["noise"]):
        for place, name in enumerate(dataset["function"].to_numpy()):
            one = dataset.isel(noise=noise, function=place)
            unit = float(one["deviation"])
            end = one.isel(s=-1)
            rows.append((
                f"{float(one['noise']):.4g}", str(name).replace("_", " "),
                f"{float(one['expectation']):.6g}",
                _with_error(end, "error", unit),
                _with_error(one, "asymptotic_variance", unit**2),
            ))  # fmt: skip
    headings = ("A", "function f", "E f", "error at the end", "limit of s e²")
    return Table("Errors of averages.", headings, rows, words=frozenset({1}))


def _with_error(one: xr.Dataset, name: str, unit: float) -> str:
    value, error = (float(one[key]) / unit for key in
                    (name, f"{name}_standard_error"))  # fmt: skip
    return f"{value:.4g} ± {error:.1g}"
