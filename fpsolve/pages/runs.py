"""What the pages about runs over s share: how they ended, their steps, their errors."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from fpsolve.evolution.series import long_name
from fpsolve.pages.blocks import Block, Notice, Table
from fpsolve.pages.numbers import evenly
from fpsolve.pages.origin import status_notice

__all__ = ["NOT_EXTRAPOLATED", "error_table", "outcome", "saved_rows", "step_text"]

NOT_EXTRAPOLATED = "Not extrapolated: no estimate of the error in ds."


def outcome(solution: Any, message: str = "") -> list[Block]:
    """Say how a run ended, and whether there are estimates of its errors."""
    warning = [] if solution.errors else [Notice(NOT_EXTRAPOLATED, "warning")]
    return [status_notice(solution.status, message), *warning]


def step_text(solution: Any) -> str:
    """Return the step and how far it led."""
    s = solution.series["s"]
    reached = f", s from {s[0]:g} to {s[-1]:g}" if s.size else ""
    levels = getattr(solution, "provenance", {}).get("levels", 2)
    steps = " and ds/2" if levels == 2 else f", …, ds/{levels}"
    also = f"{steps}, extrapolated" if solution.errors else ""
    return f"ds = {solution.ds:g}{also}{reached}"


def saved_rows(solution: Any) -> dict[int, int]:
    """Return evenly spaced places of saved s, with the recorded step nearest to each.

    Steps are recorded at the saved arclengths, up to rounding.
    """
    s, saved = solution.series["s"], solution.saved_s
    return {
        place: int(np.argmin(np.abs(s - saved[place]))) for place in evenly(saved.size)
    }


def error_table(
    errors: Mapping[str, Any], caption: str, names: Mapping[str, str]
) -> Table:
    """Return the largest of every estimated error, under other names where given."""
    rows = [
        (names.get(name) or long_name(name), f"{float(np.max(values)):.1e}")
        for name, values in errors.items()
        if np.size(values) and np.isfinite(values).all()
    ]
    return Table(caption, ("quantity", "at most"), rows, words=frozenset({0}))
