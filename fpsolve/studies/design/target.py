"""What is asked of a web: as even as possible, or even enough at the least cost."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array, check_finite_numbers
from fpsolve._support.checks import check_one_of, check_positive, has_length, shown

__all__ = ["COSTS", "Target", "target_of"]

# What is as large as possible where a bound is met, by what it costs when it is not.
COSTS = {"throughput": "speed_ratio", "positions": "spacing", "fineness": "titer"}


@dataclass(frozen=True, eq=False)
class Target:
    """Zones, and the largest CV of each where there are bounds.

    Attributes
    ----------
    zones : ndarray
        Sides in metres.
    largest : ndarray
        NaN everywhere where CV is to be as small as possible.
    """

    zones: Array
    largest: Array

    @property
    def bounded(self) -> bool:
        """Whether CV is bounded, and not minimised."""
        return bool(np.isfinite(self.largest).all())


def target_of(target: Any) -> Target:
    """The target of the arguments of `design_web`, checked but for sizes of zones."""
    if isinstance(target, Mapping):
        target = list(target.items())
    if isinstance(target, list | tuple) and any(map(_is_pair, target)):
        return _bounded(target)
    zones = np.atleast_1d(check_finite_numbers("target", target)).ravel()
    if not zones.size:
        raise ValueError("`target` must name a zone at least, got none.")
    return Target(zones, np.full(zones.shape, np.nan))


def pairs_of(target: Any) -> Any:
    """A target as a call can be recorded: pairs for a mapping."""
    return list(map(list, target.items())) if isinstance(target, Mapping) else target


def check_cost(cost: Any, target: Target, names: tuple[str, ...]) -> None:
    """Raise ValueError unless what a bound costs can change."""
    check_one_of("cost", cost, COSTS)
    if target.bounded and COSTS[cost] not in names:
        raise ValueError(
            f"`free` must name {COSTS[cost]} for the cost {cost!r}, got "
            f"{', '.join(names)}; free it, or choose another `cost`."
        )


def _bounded(pairs: Any) -> Target:
    wrong = [pair for pair in pairs if not _is_pair(pair)]
    if wrong:
        raise ValueError(
            "`target` must be zones, or give the largest CV of every zone, got "
            f"{shown(wrong[0])} without one."
        )
    zones = [check_positive("target", zone) for zone, _ in pairs]
    largest = [check_positive("target", cv) for _, cv in pairs]
    too_large = [cv for cv in largest if not cv < 1]
    if too_large:
        raise ValueError(
            "`target` must bound CV below 1, that is 100 %, got "
            f"{too_large[0]:g}; per cent given instead?"
        )
    return Target(np.array(zones), np.array(largest))


def _is_pair(one: Any) -> bool:
    return not isinstance(one, str) and has_length(one, 2)
