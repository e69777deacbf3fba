"""How often a run writes a checkpoint: steps or time."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from fpsolve._support.checks import check_integer

__all__ = ["Interval", "parse_interval"]

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
