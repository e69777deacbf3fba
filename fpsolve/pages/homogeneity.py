"""The page about webs that were laid beside their prediction."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.declared import declared
from fpsolve.pages.blocks import Facts, Part, Section, Table
from fpsolve.pages.equations import fokker_planck, smooth_fokker_planck
from fpsolve.pages.figures import drawings
from fpsolve.pages.studies import (
    cases_blocks,
    listed,
    potential_equations,
    versions_part,
)

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["section"]

_CAPTION = "Coefficient of variation of square zones, laid and predicted."
_NOTE = (
    "z: difference of both CV² over its error, which has Student's distribution with "
    "one degree of freedom less than there are webs. A dash: not known."
)
_AXES = ("noise", "belt_speed", "spacing", "zone")
_HEADINGS = ("A", "v", "d", "side x", "predicted", "error", "laid", "error", "z")


def section(dataset: xr.Dataset, source: str) -> Section:
    """Return the section of a page about laid and predicted webs."""
    about = declared(dataset.attrs)
    items = [
        ("potential", f"B = {about['formula']}"),
        ("noises A", listed(dataset["noise"])),
        *(
            [("relaxation length R", f"{about['relaxation_length']:g}")]
            if "relaxation_length" in about
            else []
        ),
        ("belt speeds v", listed(dataset["belt_speed"])),
        ("distances d", listed(dataset["spacing"])),
        ("positions", str(about["positions"])),
        ("webs of a case", f"{about['n_webs']:g}"),
        ("pixel", f"{about['pixel']:g}"),
        ("step", f"ds = {about['ds']:g}" if "ds" in about else "chosen by `lay_web`"),
        ("tolerance of the prediction", f"{about['tolerance']:g}"),
    ]
    smooth = "relaxation_length" in about
    equation = smooth_fokker_planck() if smooth else fokker_planck()
    equations = [equation, *potential_equations(dataset)]
    return Section("Laid and predicted webs", source, [
        Part("Summary", cases_blocks(dataset)),
        Part("Equation", equations),
        Part("Parameters", [Facts(items)]),
        Part("Variation", [Table(_CAPTION, _HEADINGS, _rows(dataset), _NOTE)]),
        Part("Figures", drawings(dataset)),
        versions_part(dataset),
    ])  # fmt: skip


def _rows(dataset: xr.Dataset) -> list[tuple[str, ...]]:
    axes = [dataset[name].to_numpy() for name in _AXES]
    rows = []
    for place in np.ndindex(dataset["z"].shape):
        at = [f"{axis[n]:g}" for axis, n in zip(axes, place, strict=True)]
        rows.append((
            *at,
            _said(dataset["predicted"].to_numpy()[place], ".5g"),
            _said(dataset["predicted_error"].to_numpy()[place], ".1e"),
            _said(dataset["simulated"].to_numpy()[place], ".5g"),
            _said(dataset["standard_error"].to_numpy()[place], ".1e"),
            _said(dataset["z"].to_numpy()[place], ".2f"),
        ))  # fmt: skip
    return rows


def _said(number: Any, form: str) -> str:
    return f"{number:{form}}" if np.isfinite(number) else "–"
