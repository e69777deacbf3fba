"""How much every cell of a web moves a number that is measured on it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fpsolve._support.arrays import Array

__all__ = ["influence"]

# Of the standard deviation of a field: differences of smooth functions of means are
# then exact to 1e-8 or so, far more than the length of a memory needs.
_STEP = 1e-3


def influence(function: Callable[[Array], Array], fields: list[Array]) -> Array:
    """u = Σ_j ∂f/∂μ_j (F_j - μ_j): f(means) is f(μ) + ⟨u⟩ but for squares of errors.

    Parameters
    ----------
    function : callable
        f of an array of means on its last axis.
    fields : list of array
        F_j, whose means over the web are μ_j.
    """
    means = np.array([field.mean() for field in fields])
    moved = np.zeros(fields[0].shape)
    for j, field in enumerate(fields):
        step = np.zeros(len(fields))
        step[j] = _STEP * float(field.std())
        # A constant moves nothing.
        if step[j] > 0:
            rise = float(function(means + step) - function(means - step))
            moved += rise / (2.0 * step[j]) * (field - means[j])
    return moved
