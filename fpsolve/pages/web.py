"""The page about a web."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fpsolve.pages.blocks import Facts, Part, Section, Table
from fpsolve.pages.figures import drawings
from fpsolve.pages.origin import provenance_part
from fpsolve.pages.settings import model_facts, model_or_unread

if TYPE_CHECKING:
    from fpsolve.web.web import Web

__all__ = ["section"]

# Zones of a page, in pixels, as far as they fit four times across the web.
_ZONES, _FEWEST = (1, 2, 5, 10, 20, 50, 100), 4


def section(web: Web, source: str) -> Section:
    """Return the section of a page about a web."""
    unit = f" {web.unit}" if web.unit else ""
    rows, columns = web.length_density.shape
    items = [
        *model_facts(web.model),
        ("window", f"{web.width:g} × {web.length:g}{unit}, across × along the belt"),
        ("pixels", f"{rows} × {columns} of {web.pixel:.4g}{unit}"),
        ("spinning positions", f"{web.positions.size}, {web.spacing:.4g}{unit} apart"),
        ("step", f"ds = {web.ds:.4g}{unit}"),
        ("seed", str(web.seed)),
        ("laid length", f"{web.laid_length:.6g}{unit}, {web.inside_length:.6g}{unit} "
         "of it in the window"),
        ("before it counts", f"{web.burn_in:.4g}{unit} of every fibre, after which "
         f"{web.burn_in_error:.1g} of the start is left"),
        ("beyond the margins", f"at most {web.margin_error:.1g} of the fibres"),
    ]  # fmt: skip
    if web.base_weight is not None:
        items.append(("base weight", f"titer/(v d) = {web.base_weight:.4g} g/m²"))
    return Section("Web", source, [
        Part("Equation", [*model_or_unread(web.model, web.provenance)]),
        Part("Parameters", [Facts(items)]),
        Part("Homogeneity", [_means(web), _variation(web)]),
        Part("Figures", drawings(web)),
        provenance_part(web.provenance, call=web.call),
    ])  # fmt: skip


def _means(web: Web) -> Table:
    mean, tensor = web.mean_length_density(), web.mean_orientation
    rows = [
        ("length per area", f"{mean:.6g} ± {mean.standard_error:.1g}"),
        ("1/(v d)", f"{web.expected_density:.6g}"),
        ("share of τ₁τ₁, along the belt", f"{tensor[0, 0]:.4g}"),
        ("share of τ₂τ₂, across the belt", f"{tensor[1, 1]:.4g}"),
    ]
    words = frozenset({0})
    return Table("Means over the window.", ("quantity", "value"), rows, words=words)


def _variation(web: Web) -> Table:
    fewest = min(web.length_density.shape) // _FEWEST
    rows = []
    for number in _ZONES:
        if number <= max(fewest, 1):
            found: Any = web.coefficient_of_variation(number * web.pixel)
            value = f"{found:.4g} ± {found.standard_error:.1g}"
            rows.append((f"{number * web.pixel:.4g}", value))
    said = "Coefficients of variation of the mass of square zones, standard errors."
    return Table(said, ("side", "CV"), rows)
