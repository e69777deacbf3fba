"""The page about a time-periodic density."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fpsolve.evolution.series import long_name
from fpsolve.pages.blocks import Facts, Notice, Paragraph, Part, Section, Table
from fpsolve.pages.equations import mathml
from fpsolve.pages.figures import drawings
from fpsolve.pages.origin import provenance_part
from fpsolve.pages.settings import grid_text, model_facts, model_or_unread

if TYPE_CHECKING:
    from fpsolve.density.periodic.result import PeriodicState

__all__ = ["section"]

_PERIODIC = "p(s + P) = p(s): the density that every start tends to, phase by phase."
# Error up to which nothing is to be done.
_SMALL = 1e-3


def section(result: PeriodicState, source: str) -> Section:
    """Return the section of a page about a time-periodic density."""
    told = ", ".join(f"{name} {size:.1e}" for name, size in result.errors.items())
    said = f"Estimated L1 error at every phase: {result.error:.2g} ({told})."
    tone = "good" if result.error <= _SMALL else "warning"
    items = [
        *model_facts(result.model),
        ("period", f"P = {result.period:.6g}, {result.s.size} phases"),
        ("grid", grid_text(result.grid)),
        ("step", f"ds = {result.ds:.4g}, several steps combined"),
        ("residual", f"{result.residual:.2g} per unit of s"),
        ("evolutions", str(result.n_applications)),
    ]
    equation = [
        *model_or_unread(result.model, result.provenance),
        mathml("p(s + P) = p(s)", "p(s + P) = p(s)"),
        Paragraph(_PERIODIC),
    ]
    tone = "good" if result.error <= _SMALL else "warning"
    return Section("Time-periodic density", source, [
        Part("Summary", [Notice(said, tone)]),
        Part("Equation", equation),
        Part("Parameters", [Facts(items)]),
        Part("Moments", [_moments(result)]),
        Part("Figure", drawings(result)),
        provenance_part(result.provenance, call=result.call),
    ])  # fmt: skip


def _moments(result: PeriodicState) -> Table:
    rows = [
        (long_name(name), *(f"{value:.8g}" for value in
                            (values.mean(), values.min(), values.max())),
         f"{np.max(result.moment_errors.get(name, np.nan)):.1e}")
        for name, values in result.moments().items()
    ]  # fmt: skip
    headings = ("moment", "mean over the period", "least", "largest", "error")
    return Table("Moments over the period and their largest estimated errors.",
                 headings, rows, words=frozenset({0}))  # fmt: skip
