"""The page about a web that was designed."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fpsolve.pages.blocks import Block, Facts, Notice, Part, Section, Table
from fpsolve.pages.equations import model_equations
from fpsolve.pages.figures import drawings
from fpsolve.pages.origin import provenance_part

if TYPE_CHECKING:
    from fpsolve.studies.design.result import WebDesign

__all__ = ["section"]

_UNITS = ("m⁻¹ᐟ²", "m", "m", "", "m", "g/m", "m")
_NOTE = (
    "A multiplier is what the logarithm of the objective gains per logarithm that the "
    "bound gives way. An error of inf: CV does not tell this parameter."
)


def section(design: WebDesign, source: str) -> Section:
    """Return the section of a page about a designed web."""
    aim = "the mean of log CV is smallest"
    if design.bounded:
        aim = f"CV is within its bounds at the least cost ({design.cost})"
    items = [
        ("aim", aim),
        ("base weight", f"titer/(v d) = {design.base_weight:.6g} g/m²"),
        ("throughput", f"{design.throughput:.6g} kg/h per metre of width"),
        ("positions", design.positions),
        ("spinning speed", f"{design.process.spinning_speed:g} m/s"),
        ("gradient left", f"{design.kkt_residual:.1e} per logarithm of a parameter"),
        ("predictions", str(design.n_predictions)),
    ]
    return Section("Design of a web", source, [
        Part("Equation", [*model_equations(design.process.model)]),
        Part("Summary", [_held(design), Facts(items)]),
        Part("Parameters", [_parameters(design)]),
        Part("Homogeneity", [_zones(design), *_front(design)]),
        Part("Figure", drawings(design)),
        provenance_part(design.provenance, call=design.call),
    ])  # fmt: skip


def _held(design: WebDesign) -> Block:
    if not design.active:
        return Notice("No bound holds the optimum.", "good")
    return Notice(f"Held by {', '.join(design.active)}.", "warning")


def _parameters(design: WebDesign) -> Table:
    columns = (
        design.parameters, _UNITS, design.values, design.value_errors, design.lower,
        design.upper, design.lower_multipliers, design.upper_multipliers,
    )  # fmt: skip
    rows = []
    for name, unit, value, error, low, high, *multipliers in zip(*columns, strict=True):
        if name == "relaxation_length" and not value:
            continue
        is_free = name in design.free
        rows.append((
            name, f"{value:.5g} {unit}".rstrip(),
            f"{100 * error:.1g} %" if is_free else "held",
            f"{low:g} to {high:g}" if is_free else "–",
            f"{max(multipliers):.3g}" if max(multipliers) > 0 else "–",
        ))  # fmt: skip
    headings = ("parameter", "optimum", "error", "bounds", "multiplier")
    told = "Parameters of the optimum."
    return Table(told, headings, rows, _NOTE, words=frozenset({0}))


def _zones(design: WebDesign) -> Table:
    rows = []
    for n, zone in enumerate(design.zones):
        bound = design.largest[n]
        laid = (f"{design.simulated[n]:.4g}", f"{design.standard_errors[n]:.1e}",
                f"{design.z[n]:.2f}") if design.n_webs else ("–",) * 3  # fmt: skip
        rows.append((
            f"{zone:g} m", f"{design.history_cv[0, n]:.5g}", f"{design.cv[n]:.5g}",
            f"{design.errors[n]:.1e}", "–" if math.isnan(bound) else f"{bound:g}",
            *laid,
        ))  # fmt: skip
    headings = ("side", "CV at the start", "CV", "error", "bound", "laid", "error", "z")
    told = f"Coefficient of variation of square zones; {design.n_webs} webs laid each."
    return Table(told, headings, rows)


def _front(design: WebDesign) -> list[Block]:
    if not design.front.size:
        return []
    headings = (
        "throughput", *(name for name in design.parameters if name in design.free),
        *(f"CV at {zone:g} m" for zone in design.zones),
    )  # fmt: skip
    free = [design.parameters.index(name) for name in design.free]
    rows = [
        (f"{throughput:.4g}", *(f"{number:.4g}" for number in (*values[free], *cv)))
        for throughput, values, cv in zip(
            design.front_throughput, design.front, design.front_cv, strict=True
        )
    ]
    return [Table("The most even webs by throughput in kg/(h m).", headings, rows)]
