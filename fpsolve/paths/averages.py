"""Averages along paths, of which Theorem 3.3 speaks."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, TypeAlias

import numpy as np

from fpsolve._support.arrays import Array, check_answers
from fpsolve._support.checks import check_call
from fpsolve.paths.ensemble import Ensemble, angle_of

__all__ = ["Observable", "observed", "time_averages"]

Observable: TypeAlias = Callable[[Array, Array, Array], Any]
Legs: TypeAlias = Iterable[tuple[int, Array]]
Trace: TypeAlias = Callable[[int, int], Legs]

# Paths whose states are held at every step of a leg.
GROUP = 1024


def observed(f: Observable, xi1: Array, xi2: Array, alpha: Array) -> Array:
    """Values of f, checked.

    Raises
    ------
    ValueError
        If f does not work elementwise or gives NaN or infinity.
    """
    check_call("f", f, "f(xi1, xi2, alpha)")
    values = check_answers("f", f(xi1, xi2, alpha))
    if values.shape not in ((), xi1.shape):
        raise ValueError(
            f"`f` must work elementwise, got shape {values.shape} for arguments of "
            f"shape {xi1.shape}."
        )
    if not np.isfinite(values).all():
        values = np.broadcast_to(values, xi1.shape)
        bad = tuple(np.argwhere(~np.isfinite(values))[0])
        raise ValueError(
            f"`f` must be finite on the paths, got {values[bad]:g} at xi = "
            f"({xi1[bad]:g}, {xi2[bad]:g}), alpha = {alpha[bad]:g}."
        )
    return np.broadcast_to(values, xi1.shape)


def time_averages(
    ensemble: Ensemble, trace: Trace, functions: Sequence[Observable]
) -> Array:
    """(1/s)∫ f ds by the trapezoidal rule; shape (n_functions, n_saved, n_paths).

    Parameters
    ----------
    ensemble : Ensemble
    trace : callable
        ``trace(first, n)`` yields the states of some paths leg by leg; see `traced`.
    functions : sequence of callables
    """
    saves, n_paths = ensemble.schedule.saves, ensemble.n_paths
    averages = np.empty((len(functions), len(saves), n_paths))
    for first in range(0, n_paths, GROUP):
        n = min(GROUP, n_paths - first)
        group = slice(first, first + n)
        averages[:, :, group] = group_averages(saves, trace(first, n), functions, n)
    return averages


def group_averages(
    saves: Sequence[int], legs: Legs, functions: Sequence[Observable], n: int
) -> Array:
    """The averages of a group of paths; shape (n_functions, n_saved, n)."""
    averages = np.full((len(functions), len(saves), n), np.nan)
    # Sums over all steps so far; the ends of the trapezoidal rule count one half.
    sums, starts = np.zeros((2, len(functions), n))
    for step, states in legs:
        xi1, xi2, alpha = states[:, 0], states[:, 1], angle_of(states)
        inside = [at for at, stop in enumerate(saves) if 0 <= stop - step < len(states)]
        for row, f in enumerate(functions):
            values = observed(f, xi1, xi2, alpha)
            if step == 0:
                starts[row] = values[0]
            for at in inside:
                ends = 0.5 * (starts[row] + values[saves[at] - step])
                here = sums[row] + values[: saves[at] - step + 1].sum(axis=0) - ends
                if saves[at] > 0:
                    averages[row, at] = here / saves[at]
            sums[row] += values.sum(axis=0)
    return averages
