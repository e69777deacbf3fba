"""Studies of the white-noise limit of smooth fibres: distances, orders, figures."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fpsolve._support.declared import declared
from fpsolve.pages.blocks import Facts, Part, Section
from fpsolve.pages.equations import fokker_planck, smooth_fokker_planck
from fpsolve.pages.figures import drawings
from fpsolve.pages.limits import large_rows, table_of
from fpsolve.pages.studies import (
    cases_blocks,
    listed,
    potential_equations,
    start_of,
    versions_part,
)

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["white_section"]

_NOTE = (
    "Orders are in R; *: below three times its numerical error, so that it cannot be "
    "told from zero. A dash: not known."
)


def white_section(dataset: xr.Dataset, source: str) -> Section:
    """Return the section of a page about the white-noise limit."""
    about = declared(dataset.attrs)
    items = [
        ("potential", f"B = {about['formula']}"),
        ("noise A = RK", f"{about['noise']:g}"),
        ("relaxation lengths R", listed(dataset["relaxation_length"])),
        ("compared at", f"s = {about['s_end']:g}"),
        ("belt speed", f"v = {about['belt_speed']:g}"),
        ("start", start_of(about["p0"])),
        ("paths", f"{about['n_paths']:g}"),
        ("resolution", "quick" if about["quick"] else "full"),
    ]
    meanings = dataset["meaning"].to_numpy()
    rows = [
        {**row, "quantity": str(meaning)}
        for row, meaning in zip(
            large_rows(dataset, "relaxation_length", "R"), meanings, strict=True
        )
    ]
    caption = "Distance of smooth fibres from the basic model with the same noise A."
    equations = [smooth_fokker_planck(), fokker_planck(), *potential_equations(dataset)]
    return Section("Smooth fibres and their white-noise limit", source, [
        Part("Summary", cases_blocks(dataset)),
        Part("Equation and its limit", equations),
        Part("Parameters", [Facts(items)]),
        Part("Distances", [table_of(caption, rows, _NOTE, words=frozenset({0}))]),
        Part("Figures", drawings(dataset)),
        versions_part(dataset),
    ])  # fmt: skip
