"""What a caller says about checkpoints: where, and how often."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from fpsolve._support.checks import check_integer, check_path

__all__ = ["Checkpoint", "Interval", "as_checkpoint", "parse_interval"]

_UNITS = {"s": 1.0, "min": 60.0, "h": 3600.0}
_DURATION = re.compile(r"\s*(\d+(?:\.\d*)?|\.\d+)\s*(s|min|h)\s*")


@dataclass(frozen=True)
class Interval:
    """Steps or seconds between two checkpoints; the other one is infinite."""

    steps: float = math.inf
    seconds: float = math.inf

    def over(self, ahead: int, seconds: float) -> bool:
        """Whether one is due: the next record is so many steps from the last one.

        By then more than the interval could be lost; or seconds have passed already.
        """
        return ahead > self.steps or seconds >= self.seconds


def parse_interval(every: int | str) -> Interval:
    """Return the interval that a number of steps or a duration like "5min" means.

    Raises
    ------
    ValueError
        If it is neither, or not positive.
    TypeError
        If it is neither an integer nor a string.
    """
    if not isinstance(every, str):
        return Interval(steps=check_integer("every", every, at_least=1))
    if every.strip().isdecimal():
        return Interval(steps=check_integer("every", int(every), at_least=1))
    found = _DURATION.fullmatch(every)
    if found is None or not float(found[1]) > 0:
        raise ValueError(
            "`every` must be a number of steps, such as 100, or a duration, such as "
            f"'30s', '5min' or '2h', got {every!r}."
        )
    return Interval(seconds=float(found[1]) * _UNITS[found[2]])


@dataclass(frozen=True)
class Checkpoint:
    """Where a run keeps what it needs to go on after a kill, and how often.

    A checkpoint is written once in every interval, at a record; at the end; and
    when Ctrl-C is pressed. Saved densities go to the folder as they come and do not
    stay in memory.

    Parameters
    ----------
    directory : str or os.PathLike
        Folder, new or that of the same run, which then goes on.
    every : int or str
        Steps between two checkpoints, or a duration such as "30s", "5min" or "2h".
        What a kill loses is at most that, or the way to the next record if longer.
    notes : mapping of str, optional
        Kept beside the description of the run.

    Raises
    ------
    ValueError, TypeError
        If `every` is not positive, or neither steps nor a duration, or `directory` no
        path.
    """

    directory: str | os.PathLike[str]
    every: int | str = "1min"
    notes: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        parse_interval(self.every)
        check_path("directory", self.directory)

    @property
    def folder(self) -> Path:
        """The folder as a path."""
        return Path(self.directory)

    @property
    def interval(self) -> Interval:
        """The interval in steps or seconds."""
        return parse_interval(self.every)


def as_checkpoint(checkpoint: Checkpoint | str | os.PathLike[str]) -> Checkpoint:
    """Return a checkpoint for the folder that a path names, or the given one."""
    if isinstance(checkpoint, Checkpoint):
        return checkpoint
    if not isinstance(checkpoint, str | os.PathLike):
        raise TypeError(
            f"`checkpoint` must be a Checkpoint or a path, got {checkpoint!r}; write "
            "Checkpoint(folder, every=100)."
        )
    return Checkpoint(checkpoint)
