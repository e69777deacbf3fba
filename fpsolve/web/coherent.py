"""What the mean of every fibre adds: strips along the machine direction."""

from __future__ import annotations

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.spectral.resolvent.fibre import Fibre
from fpsolve.web.zone_variance import window_integrals

__all__ = ["Bounded", "across_power", "orientation", "random_positions", "strips"]

# |k2| σ2 beyond which the law of ξ2 has no part; e^{−32} is left.
END = 8.0
# Numbers, and bounds of their errors.
Bounded = tuple[Array, Array]


def across_power(ladder: Fibre, k2: Array) -> Bounded:
    """|φ(0, k2)|² of the stationary law of ξ2."""
    fine, coarse = ladder.characteristics(k2)
    return fine**2, 2 * np.abs(fine**2 - coarse**2)


def strips(ladder: Fibre, spacing: float, n: int) -> Bounded:
    """2 |φ(0, 2πj/d)|, j = 1 … n: amplitudes of the mean over regular positions."""
    power, errors = across_power(ladder, harmonics_of(spacing, n))
    amplitudes = 2 * np.sqrt(power)
    # From an error of the square, which bounds that of a root near zero, too.
    return amplitudes, np.minimum(
        2 * np.sqrt(errors), 4 * errors / np.maximum(amplitudes, 1e-300)
    )


def harmonics_of(spacing: float, n: int) -> Array:
    """2πj/d, j = 1 … n."""
    return np.asarray(2 * np.pi / spacing * np.arange(1.0, n + 1.0))


def regular_positions(
    ladder: Fibre, spacing: float, zone: float
) -> tuple[float, float]:
    """Σ 2 |φ(0, 2πj/d)|² sinc²(πjx/d), j >= 1: variance of zones by spacing strips."""
    n = max(1, int(END * spacing / (2 * np.pi * ladder.scales[1])))
    k2 = harmonics_of(spacing, n)
    power, errors = across_power(ladder, k2)
    window = 2 * np.sinc(k2 * zone / (2 * np.pi)) ** 2
    return float(window @ power), float(window @ errors)


def random_positions(ladder: Fibre, spacing: float, zone: float) -> tuple[float, float]:
    """d ∫ |φ(0, k2)|² sinc²(k2 x/2) dk2/2π: of independent positions."""
    k2, weights = window_integrals(zone, 0.0, END / ladder.scales[1])
    power, errors = across_power(ladder, k2)
    factor = spacing / np.pi
    return float(factor * weights @ power), float(factor * weights @ errors)


def orientation(ladder: Fibre) -> Bounded:
    """⟨τ⊗τ⟩, two by two, index 0 along the belt: (1 ± E cos 2α)/2, E sin 2α = 0."""
    fine, coarse = ladder.double_cosines()
    error = abs(fine - coarse) * np.eye(2)
    return np.diag([0.5 * (1 + fine), 0.5 * (1 - fine)]), error
