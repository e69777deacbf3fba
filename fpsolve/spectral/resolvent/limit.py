"""The end of short waves: straight pieces of fibre, known by the law of their angle."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array
from fpsolve.spectral.resolvent.generator import Generator

__all__ = ["angle_density", "angle_harmonics", "short_wave_limit"]


def angle_harmonics(generator: Generator) -> Array:
    """E cos kα in the stationary law, k = 0, 1, …; E sin kα vanishes."""
    m, n, harmonic = generator.basis.states
    _, cosine = generator.basis.circle
    found = np.flatnonzero((m + n == 0) & cosine[harmonic])
    values = generator.stationary[found] / math.sqrt(2.0)
    values[0] = 1.0
    return values


def angle_density(generator: Generator, alpha: ArrayLike) -> Array:
    """f(α) = (1 + 2 Σ E cos kα cos kα)/(2π) of the stationary law, even in α."""
    harmonics = angle_harmonics(generator)
    k = np.arange(1, harmonics.size)
    waves = np.cos(np.multiply.outer(np.asarray(alpha, float), k))
    return np.asarray((1.0 + 2.0 * waves @ harmonics[1:]) / (2 * math.pi))


def short_wave_limit(generator: Generator, k: tuple[float, float]) -> float:
    """Ŝ → (2π/|k|) [f(β + π/2) + f(β − π/2)], β the direction of k.

    On lengths of 1/|k| the fibre is straight, and only pieces across k count. For a
    law that favours no direction it is 2/|k|. Relative to it Ŝ lacks O(|k|^{−2}).
    """
    beta = math.atan2(k[1], k[0])
    across = angle_density(generator, [beta + 0.5 * math.pi, beta - 0.5 * math.pi])
    return float(2 * math.pi / math.hypot(*k) * across.sum())
