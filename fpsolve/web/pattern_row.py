"""What the phases of a row of nozzles make of the pattern of one."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array, Complex, check_finite_numbers
from fpsolve._support.checks import shown

__all__ = ["INDEPENDENT", "IN_PHASE", "of_the_row", "offsets_of"]

IN_PHASE, INDEPENDENT = "in phase", "independent"


def offsets_of(phases: Any) -> Array:
    """The phases of nozzles one after the other; 0 for words."""
    if isinstance(phases, str):
        if phases not in (IN_PHASE, INDEPENDENT):
            raise ValueError(
                f"`phases` must be {IN_PHASE!r}, {INDEPENDENT!r} or an array, got "
                f"{shown(phases)}."
            )
        return np.zeros(1)
    offsets = check_finite_numbers("phases", phases)
    if offsets.ndim != 1 or offsets.size == 0:
        raise ValueError(
            f"`phases` must have the shape (N,), got {offsets.shape}; one for every "
            "nozzle until they are repeated."
        )
    return offsets


def of_the_row(
    k1: Array, k2: Array, phases: Any, offsets: Array, spacing: float, speed: float
) -> Complex:
    """(1/N) Σ_j e^{−i(n φ_j + k₂ j d)} of N nozzles, one after the other.

    A nozzle that is ahead by a phase has laid, at the same place of the belt, what
    another lays earlier: its pattern is moved along the belt.
    """
    n = np.arange(k1.size) - k1.size // 2
    if isinstance(phases, str) and phases == INDEPENDENT:
        return np.where(n == 0, 1.0, 0.0)[:, None].astype(np.complex128)
    along = np.exp(-1j * math.copysign(1.0, speed) * np.multiply.outer(n, offsets))
    places = np.arange(offsets.size) * spacing
    across = np.exp(-1j * np.multiply.outer(places, k2))
    factors: Complex = along @ across / offsets.size
    return factors
