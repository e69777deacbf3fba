"""What a run keeps of itself: in memory, which is enough unless it is killed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any, TypeAlias

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.density.schemes.form import State

__all__ = ["MemoryKeeper", "Snapshot", "Take", "fields_of"]


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


# What takes a snapshot of a pass, of which so many densities are saved.
Take: TypeAlias = Callable[[int], Snapshot]


class MemoryKeeper:
    """What a pass does with saved densities; here it holds them, and nothing more.

    Parameters
    ----------
    shape : (int, int, int)
        Shape of a density.
    n_saves : int
        Densities that a whole pass saves.

    Attributes
    ----------
    n_saved : int
        Densities saved so far.
    """

    def __init__(self, shape: tuple[int, ...], n_saves: int) -> None:
        # Memory that is asked for is only taken when it is written; a list of densities
        # would have to be held twice to become an array.
        self.kept = np.empty((n_saves, *shape))
        self.n_saved = 0

    def last(self) -> Snapshot | None:
        """Where the pass goes on; None at its beginning."""
        return None

    def save(self, p: Array) -> None:
        """Keep a copy of a density."""
        self.kept[self.n_saved] = p
        self.n_saved += 1

    def after(self, step: int, take: Take) -> None:
        """Do what is to be done after a record at that step."""

    def finish(self, step: int, take: Take) -> None:
        """Do what is to be done at the end of the pass."""

    def interrupted(self, step: int | None, take: Take) -> str:
        """Do what is to be done after Ctrl-C; what is to be said of it.

        The step is None if the state is not that of a record.
        """
        return ""

    def densities(self) -> Any:
        """The saved densities; shape (n_saved, n1, n2, n_alpha)."""
        return self.kept[: self.n_saved]
