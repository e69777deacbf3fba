"""Checks that all parts of the energy process share."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fpsolve._support.arrays import check_numbers

__all__ = ["check_energies"]

# How far beyond g_max rounding may put an energy.
_ROUNDING = 1e-14


def check_energies(
    name: str, g: ArrayLike, g_max: float, signed: bool = False
) -> NDArray[np.float64]:
    """Return energies as float64, at most g_max; ValueError where one lies outside."""
    energies = check_numbers(name, g)
    size = np.abs(energies) if signed else energies
    inside = (size >= 0) & (size <= g_max * (1.0 + _ROUNDING))
    if not inside.all():
        lowest = f"-{g_max:.12g}" if signed else "0"
        raise ValueError(
            f"`{name}` must lie in [{lowest}, {g_max:.12g}], the energies G of the "
            f"orbits of this potential, got {energies[~inside].flat[0]:.12g}; the "
            "largest is `g_max`, that of the circle r B'(r) = 1."
        )
    return np.asarray(np.clip(energies, -g_max, g_max))
