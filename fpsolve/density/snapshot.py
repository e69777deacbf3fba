"""The state of a pass at a record, apart from what is on the disk already."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve.density.schemes.form import State

__all__ = ["Snapshot", "fields_of", "rows_to_array"]

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
    n_saved, n_stored : int
        Densities and rows that belong to it in the store; what is beyond is not
        part of this checkpoint.
    seconds : (float, float)
        Wall and CPU time spent so far.
    columns : tuple of str
        Names of the recorded quantities.
    first, tail : ndarray, shapes (n_columns,) and (n, n_columns)
        The first record, and those that are not in the store.
    state : dict
        Fields of the scheme's state.
    """

    step: int
    s: float
    n_saved: int
    n_stored: int
    seconds: tuple[float, float]
    columns: tuple[str, ...]
    first: Array
    tail: Array
    state: dict[str, Any]

    def restore(self, state: State) -> None:
        """Give a state these values."""
        for name, value in self.state.items():
            setattr(state, name, value)


def fields_of(state: State) -> dict[str, Any]:
    """Everything in a state that the next step depends on."""
    return {
        field.name: getattr(state, field.name)
        for field in fields(state)
        if field.name not in _NOT_KEPT
    }


def rows_to_array(rows: list[dict[str, float]], columns: tuple[str, ...]) -> Array:
    """Rows as an array of shape (n, n_columns)."""
    return np.array([[row[name] for name in columns] for row in rows]).reshape(
        -1, len(columns)
    )
