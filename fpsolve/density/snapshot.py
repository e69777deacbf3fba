"""The state of a pass at a record, apart from what is on the disk already."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve.density.schemes.form import State

__all__ = ["Snapshot", "fields_of"]

Array = NDArray[np.float64]

# Scratch of the next step, and nothing before it.
_NOT_KEPT = ("work", "scratch")


@dataclass(frozen=True)
class Snapshot:
    """Where a pass is, and what belongs to it.

    Attributes
    ----------
    step : int
        Steps done; a recorded one.
    s : float
    n_saved : int
        Densities that belong to it in the store; what is beyond is not part of this
        checkpoint.
    seconds : (float, float)
        Wall and CPU time spent so far.
    columns : tuple of str
        Names of the recorded quantities.
    records : ndarray, shape (n_records, n_columns)
    state : dict
        Fields of the scheme's state.
    """

    step: int
    s: float
    n_saved: int
    seconds: tuple[float, float]
    columns: tuple[str, ...]
    records: Array
    state: dict[str, Any]


def fields_of(state: State) -> dict[str, Any]:
    """Everything in a state that the next step depends on."""
    return {
        field.name: getattr(state, field.name)
        for field in fields(state)
        if field.name not in _NOT_KEPT
    }
