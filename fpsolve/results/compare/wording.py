"""A comparison in words."""

from __future__ import annotations

from fpsolve.results.compare.comparison import ROUNDING, Comparison
from fpsolve.results.compare.differences import Difference

__all__ = ["in_errors_text", "place_text", "report", "verdict"]

_MOST_ROWS = 12


def report(comparison: Comparison) -> str:
    """Return the verdict, the variables that differ most, and what else differs."""
    a, b = comparison.names
    lines = [f"A = {a}, B = {b}: {comparison.kind}", verdict(comparison)]
    shown = comparison.differing[:_MOST_ROWS]
    lines += [f"  {_line(one)}" for one in shown]
    if len(comparison.differing) > len(shown):
        lines.append(f"  and {len(comparison.differing) - len(shown)} more variables")
    for title, entries in sections(comparison).items():
        if entries:
            lines += [f"{title}:", *(f"  {entry}" for entry in entries)]
    return "\n".join(lines)


def sections(comparison: Comparison) -> dict[str, tuple[str, ...]]:
    """Return what is said below the numbers, with headings."""
    return {
        "not compared": comparison.left_out,
        "parameters that differ": comparison.parameters,
        "environment that differs": comparison.environment,
    }


def verdict(comparison: Comparison) -> str:
    """Return in a sentence or two whether both are the same, and if not how far off."""
    n = len(comparison.differences)
    if comparison.equal:
        return f"equal: the same bits in all {n} variables"
    if not comparison.differing:
        return f"what was compared is equal, the same bits in all {n} variables"
    worst = comparison.differing[0]
    text = (
        f"different in {len(comparison.differing)} of {n} variables, at most by "
        f"{worst.relative:.2g} of the largest value ({worst.name})"
    )
    if comparison.is_rounding:
        text += f"; rounding explains this (below {ROUNDING:g} of the largest value)"
    if comparison.within_errors is not None:
        inside = "within" if comparison.within_errors else "beyond"
        text += f"; {inside} the estimated errors of A and B"
    return text


def _line(one: Difference) -> str:
    text = f"{one.name}: {one.largest:.3g} ({one.relative:.2g} of the largest value)"
    place = place_text(one)
    text += f" at {place}" if place else ""
    errors = in_errors_text(one)
    return f"{text}, {errors}" if errors else text


def place_text(one: Difference) -> str:
    """Return where the difference is largest."""
    return ", ".join(
        f"{name} = {value:.3g}" if isinstance(value, float) else f"{name} = {value}"
        for name, value in one.place.items()
    )


def in_errors_text(one: Difference) -> str:
    """Return the difference in units of its error."""
    if one.in_errors is None:
        return ""
    if one.statistical:
        return f"{one.in_errors:.2g} standard errors"
    return f"{one.in_errors:.2g} of the estimated errors"
