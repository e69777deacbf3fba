"""The end of short waves: straight pieces of fibre, known by the law of their angle."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array
from fpsolve.spectral.resolvent.generator import Generator

__all__ = [
    "angle_density",
    "angle_harmonics",
    "harmonic_derivatives",
    "limit_derivatives",
    "short_wave_limit",
]


def angle_harmonics(generator: Generator) -> Array:
    """E cos kα in the stationary law, k = 0, 1, …; E sin kα vanishes."""
    values = _cosines(generator, generator.stationary)
    values[0] = 1.0
    return values


def harmonic_derivatives(generator: Generator) -> Array:
    """∂ E cos kα in every parameter, (parameter, k)."""
    return _cosines(generator, generator.stationary_derivatives)


def _cosines(generator: Generator, functional: Array) -> Array:
    """Of a functional, or of several, its values of cos kα, but for k = 0."""
    m, n, harmonic = generator.basis.states
    _, cosine = generator.basis.circle
    found = np.flatnonzero((m + n == 0) & cosine[harmonic])
    return np.asarray(functional[..., found] / math.sqrt(2.0))


def angle_density(generator: Generator, alpha: ArrayLike) -> Array:
    """f(α) = (1 + 2 Σ E cos kα cos kα)/(2π) of the stationary law, even in α."""
    return _series(angle_harmonics(generator), alpha)


def _series(harmonics: Array, alpha: ArrayLike) -> Array:
    k = np.arange(1, harmonics.size)
    waves = np.cos(np.multiply.outer(np.asarray(alpha, float), k))
    return np.asarray((harmonics[0] + 2.0 * waves @ harmonics[1:]) / (2 * math.pi))


def short_wave_limit(generator: Generator, k: tuple[float, float]) -> float:
    """Ŝ → (2π/|k|) [f(β + π/2) + f(β − π/2)], β the direction of k.

    On lengths of 1/|k| the fibre is straight, and only pieces across k count. For a
    law that favours no direction it is 2/|k|. Relative to it Ŝ lacks O(|k|^{−2}).
    """
    return _across(angle_harmonics(generator), k)


def limit_derivatives(generator: Generator, k: tuple[float, float]) -> Array:
    """∂ of `short_wave_limit` in every parameter: it is linear in f."""
    harmonics = harmonic_derivatives(generator)
    harmonics[:, 0] = 0.0
    return np.array([_across(one, k) for one in harmonics])


def _across(harmonics: Array, k: tuple[float, float]) -> float:
    beta = math.atan2(k[1], k[0])
    across = _series(harmonics, [beta + 0.5 * math.pi, beta - 0.5 * math.pi])
    return float(2 * math.pi / math.hypot(*k) * across.sum())
