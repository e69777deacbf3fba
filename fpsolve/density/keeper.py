"""Keeps what a run records in memory, which is enough unless it is killed."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve.density.one_pass import Pass
from fpsolve.evolution.schedule import Schedule

__all__ = ["MemoryKeeper", "MemoryKeepers"]

Array = NDArray[np.float64]


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

    def begin(self, run: Pass) -> bool:
        """Take a pass to where it goes on; False at its beginning."""
        return False

    def save(self, p: Array) -> None:
        """Keep a copy of a density."""
        self.kept[self.n_saved] = p
        self.n_saved += 1

    def after(self, run: Pass) -> None:
        """Do what is to be done after a record."""

    def finish(self, run: Pass) -> None:
        """Do what is to be done at the end of the pass."""

    def interrupted(self, run: Pass) -> str:
        """Do what is to be done after Ctrl-C; what is to be said of it."""
        return ""

    def densities(self) -> Any:
        """The saved densities; shape (n_saved, n1, n2, n_alpha)."""
        return self.kept[: self.n_saved]


class MemoryKeepers:
    """Hands out a keeper for every pass of a run."""

    def __init__(self, shape: tuple[int, ...]) -> None:
        self.shape = shape

    def keeper(self, name: str, schedule: Schedule) -> MemoryKeeper:
        """Return what keeps the pass of that name."""
        return MemoryKeeper(self.shape, len(schedule.saves))
