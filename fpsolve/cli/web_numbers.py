"""What `fpsolve web` prints: base weight, variation of zones, MD/CD, margins."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from fpsolve.cli.console import print_pairs, print_table

if TYPE_CHECKING:
    from fpsolve.web.statistics.estimate import Estimate
    from fpsolve.web.web import Web

__all__ = ["print_web"]


def print_web(web: Web, zones: tuple[float, ...] | None = None) -> None:
    """Print the numbers of a web with their standard errors.

    Parameters
    ----------
    web : Web
    zones : tuple of float, optional
        Sides of the squares whose variation is printed; by default 1, 2 and 5 times
        powers of ten, of which four and more fit across the web.
    """
    mean = web.mean_length_density()
    pairs = []
    if web.base_weight is not None and web.titer is not None:
        laid = _said(mean, web.titer)
        pairs.append(("base weight", f"{web.base_weight:.4g} g/m², laid {laid} g/m²"))
    per = f" {web.unit}⁻¹" if web.unit else ""
    share = web.outside_length / web.laid_length
    pairs += [
        ("length per area",
         f"{web.expected_density:.6g}{per}, laid {_said(mean)}{per}"),
        ("MD/CD", _said(web.machine_cross_ratio())),
        ("in the margins", f"{100 * share:.1f} % of what was laid, and beyond them at "
         f"most {web.margin_error:.1g} of the fibres"),
    ]  # fmt: skip
    _print_variation(web, zones)
    print_pairs(pairs)


def _print_variation(web: Web, zones: tuple[float, ...] | None) -> None:
    from fpsolve.plotting.web_image import image_of
    from fpsolve.plotting.web_quality import zones_for

    image = image_of(web)
    unit, factor = image.shown_unit
    rows = []
    for zone in zones_for(image) if zones is None else zones:
        found: Any = web.coefficient_of_variation(float(zone))
        rows.append((f"{factor * zone:g} {unit}".rstrip(), _said(found, 100.0, " %")))
    print_table(("zone", "CV"), rows)


def _said(found: Estimate, factor: float = 1.0, unit: str = "") -> str:
    """Return value ± standard error; the error is said to be unknown where it is."""
    value, error = factor * float(found), factor * found.standard_error
    if math.isnan(error):
        return f"{value:.4g}{unit} (error unknown)"
    places = max(0, 1 - math.floor(math.log10(error))) if error > 0 else 3
    return f"{value:.{places}f} ± {error:.{places}f}{unit}"
