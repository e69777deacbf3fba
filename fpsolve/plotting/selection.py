"""Which saved arclengths a figure shows."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from fpsolve.solution import Solution

__all__ = ["select_s"]


def select_s(
    solution: Solution, at: Iterable[float] | None, at_most: int
) -> list[float]:
    """Return the arclengths to show: those asked for, or saved ones evenly thinned."""
    if at is not None:
        chosen = [float(s) for s in at]
    else:
        n_saved = len(solution.saved_s)
        steps = np.linspace(0, n_saved - 1, min(n_saved, at_most)).round().astype(int)
        chosen = [float(s) for s in solution.saved_s[steps]]
    if not chosen:
        raise ValueError(
            "`solution` must hold a saved density to show, got none; name arclengths "
            "in `save_at` of the run."
        )
    return chosen
