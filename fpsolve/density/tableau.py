"""Runs with ds, ds/2, …, ds/n combined to order 2n, with the errors they tell."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.density.extrapolation import WINDOW, resolved
from fpsolve.density.negative_cells import add_cells
from fpsolve.density.solution import Solution
from fpsolve.density.unresolved import cells_error
from fpsolve.evolution.richardson import ROUNDING, levelled_series, safety, tableau
from fpsolve.evolution.series import is_extrapolated
from fpsolve.evolution.stored import LazyDensities, WeightedDensities, weighted

__all__ = ["combined", "largest_cells_error", "step_error"]


def combined(runs: Sequence[Solution]) -> Solution:
    """u = Σ_j w_j u_{ds/j}, j = 1, …, n, with w of Aitken and Neville in ds².

    The scheme's error has even powers of ds only, so u is of order 2n. The estimate is
    the difference to the combination without u_{ds}, of order 2n − 2, twice for three
    and more: it is the error of that one and covers that of u as long as the tableau
    converges. Out of the
    asymptotic range (see `extrapolation.resolved`) it is the difference to u_{ds/n},
    and so it is for what is not extrapolated. What cells leave of a trigonometric
    interpolant is added, see `negative_cells` and `unresolved`.

    Parameters
    ----------
    runs : sequence of Solution
        The same stops with ds, ds/2, ds/3, …
    """
    first, finest = runs[0], runs[-1]
    asymptotic = resolved(first)
    reach, rounding = WINDOW * min(finest.grid.half_widths), _rounding(runs)
    series, errors = levelled_series(
        [one.series for one in runs], reach, asymptotic, rounding, is_extrapolated
    )
    densities, distances = _densities(runs, asymptotic)
    errors["density_l1"] = distances + rounding
    provenance = dict(finest.provenance)
    for name in ("wall_seconds", "cpu_seconds", "n_steps"):
        provenance[name] = sum(one.provenance[name] for one in runs)
    provenance |= {"extrapolated": True, "levels": len(runs)}
    found = replace(
        finest, ds=first.ds, densities=densities, series=series, errors=errors,
        provenance=provenance,
    )  # fmt: skip
    return add_cells(found, runs)


def step_error(runs: Sequence[Solution]) -> float:
    """Largest estimated L1 error of the saved densities; nothing is changed."""
    spread = np.subtract(*tableau(len(runs)))[None]
    sizes = [
        np.abs(weighted(together, spread)[0]).sum() * runs[0].grid.cell_volume
        for together in zip(*(one.densities for one in runs), strict=True)
    ]
    return safety(len(runs)) * float(max(sizes, default=0.0))


def largest_cells_error(run: Solution) -> float:
    """Largest estimated L1 error that the cells leave in the saved densities."""
    return float(cells_error(run).max(initial=0.0))


def _densities(runs: Sequence[Solution], asymptotic: bool) -> tuple[Any, Array]:
    """The combined densities, in the memory of the finest, and their L1 errors."""
    best, lower = tableau(len(runs))
    finest, volume = np.zeros(len(runs)), runs[0].grid.cell_volume
    finest[-1] = 1.0
    weights = np.stack([best, best - (lower if asymptotic else finest)])
    kept = runs[-1].densities
    lazy = isinstance(kept, LazyDensities)
    errors = np.empty(len(kept))
    for place in range(len(kept)):
        sums = weighted([one.densities[place] for one in runs], weights)
        errors[place] = safety(len(runs)) * np.abs(sums[1]).sum() * volume
        if not lazy:
            kept[place] = sums[0]
    if lazy:
        return WeightedDensities([one.densities for one in runs], best.tolist()), errors
    return kept, errors


def _rounding(runs: Sequence[Solution]) -> float:
    """What the weights make of a rounding error in every step."""
    weights = np.abs(tableau(len(runs))[0])
    steps = [one.provenance["n_steps"] for one in runs]
    return ROUNDING * float(weights @ np.add(steps, 4.0))
