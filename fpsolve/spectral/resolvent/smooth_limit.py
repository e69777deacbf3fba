"""The end of short waves of a smooth fibre: circles, by the law of angle and κ²."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array
from fpsolve.spectral.resolvent.plane_waves import WaveVector
from fpsolve.spectral.resolvent.smooth_generator import SmoothGenerator
from fpsolve.spectral.resolvent.smooth_waves import angle_moments

__all__ = [
    "smooth_angle_density",
    "smooth_angle_limit",
    "smooth_short_wave_limit",
]


def smooth_angle_density(generator: SmoothGenerator, alpha: ArrayLike) -> Array:
    """f(α) = (1 + 2 Σ E cos kα cos kα)/(2π) of the stationary law, even in α."""
    return _summed(angle_moments(generator, 0), alpha)


def smooth_angle_limit(
    generator: SmoothGenerator, k: WaveVector, law: Array | None = None
) -> float:
    """(2π/|k|) [f(β + π/2) + f(β − π/2)], of straight pieces; of another `law`, too."""
    straight = _summed(angle_moments(generator, 0, law), _across(k)).sum()
    return float(2 * math.pi * straight / math.hypot(*k))


def smooth_short_wave_limit(
    generator: SmoothGenerator, k: WaveVector, law: Array | None = None
) -> float:
    """Ŝ → Σ± [2π f/|k| + π (f₂⁗ − 2 f₂″ − 3 f₂)/(12 |k|³)](β ± π/2), β that of k.

    f is the density of the angle and f₂ = E[κ² | α] f. On lengths of 1/|k| the fibre is
    an arc of a circle, since about the middle of a piece E[κ' | α] f = f₂′: both
    together make the phase k·(η_s − η_0) = |k| s cos θ with a correction k² s⁴ f₂
    sin²θ/24 to its mean. Without a preferred direction it is 2/|k| − E κ²/(4|k|³).
    Relative to it Ŝ lacks O(|k|⁻⁴). It is linear in the law, and so its own derivative
    where `law` is that of the stationary law.
    """
    size, across = math.hypot(*k), _across(k)
    moments = angle_moments(generator, 2, law)
    n2 = np.arange(moments.size) ** 2
    bent = _summed(moments * (n2**2 + 2 * n2 - 3), across).sum()
    straight = smooth_angle_limit(generator, k, law)
    return straight + float(math.pi * bent / (12 * size**3))


def _across(k: WaveVector) -> Array:
    """The two directions across k."""
    beta = math.atan2(k[1], k[0])
    return np.array([beta + 0.5 * math.pi, beta - 0.5 * math.pi])


def _summed(harmonics: Array, alpha: ArrayLike) -> Array:
    """(h_0 + 2 Σ h_k cos kα)/(2π)."""
    k = np.arange(1, harmonics.size)
    waves = np.cos(np.multiply.outer(np.asarray(alpha, float), k))
    return np.asarray((harmonics[0] + 2.0 * waves @ harmonics[1:]) / (2 * math.pi))
