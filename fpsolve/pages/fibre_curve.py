"""The page about a fibre that was measured or simulated elsewhere."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fpsolve.pages.blocks import Facts, Part, Section
from fpsolve.pages.figures import drawings
from fpsolve.pages.origin import provenance_part
from fpsolve.pages.settings import curve_text

if TYPE_CHECKING:
    from fpsolve.paths.fibres.fibre_curve import FibreCurve

__all__ = ["section"]


def section(fibre: FibreCurve, source: str) -> Section:
    """Return the section of a page about a fibre curve."""
    items = [
        ("fibres", f"{len(fibre.lengths)}"),
        ("points", f"{len(fibre.eta)} at distances of Δs = {fibre.ds:g}"),
        ("length", f"{fibre.length:.6g}"),
        ("reference curve",
         "unknown" if fibre.curve is None else curve_text(fibre.curve)),
        ("standard deviation of the points", f"{fibre.position_error:g}"),
        ("error of resampled points", f"{fibre.resampling_error:.2g}"),
    ]  # fmt: skip
    return Section("Fibre on the belt", source, [
        Part("Data", [Facts(items)]),
        Part("Figure", drawings(fibre)),
        provenance_part(fibre.provenance, call=fibre.call),
    ])  # fmt: skip
