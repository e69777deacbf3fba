"""One step of length h of κ, α and ∫α under a drift that changes linearly, and noise.

dα = κ ds, dκ = (f - κ)/R ds + K dW with f(u) = f + Δ u/h. With x = h/R and
φₖ(x) = Σⱼ (-x)ʲ/(j + k)!, so that φ₀ = e⁻ˣ and φ₁ = (1 - e⁻ˣ)/x,

    κ(h) = φ₀ κ + x φ₁ f + x φ₂ Δ + noise,
    α(h) = α + h (φ₁ κ + x φ₂ f + x φ₃ Δ) + noise,
    (1/h)∫ α du = α + h (φ₂ κ + x φ₃ f + …) + noise.

The noise is ∫ K g(h - u) dW with g(u) = (e^{-u/R}, u φ₁(u/R), (u²/h) φ₂(u/R)), and its
covariance K² ∫ g gᵀ du. All terms of these sums and integrals have one sign where they
matter: nothing cancels, neither for R → 0 nor for R → ∞.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._kernels.paths import SmoothStep
from fpsolve._support.arrays import Array

__all__ = ["phi", "smooth_step"]

# Terms after which the series of φₖ for x < 1 is exact to rounding.
_N_TERMS = 20
# Where e⁻ˣ is gone, and nodes that integrate e^{-2x} up to there to rounding.
_FADED, _N_NODES = 40.0, 64


def phi(k: int, x: ArrayLike) -> Array:
    """φₖ(x) = Σⱼ (-x)ʲ/(j + k)! for x >= 0."""
    x = np.asarray(x, dtype=np.float64)
    near, far = np.minimum(x, 1.0), np.maximum(x, 1.0)
    series = np.full_like(x, 1 / math.factorial(k + _N_TERMS))
    for j in range(_N_TERMS - 1, -1, -1):
        series = 1 / math.factorial(j + k) - near * series
    recursion = np.exp(-far)
    for j in range(k):
        recursion = (1 / math.factorial(j) - recursion) / far
    return np.where(x < 1, series, recursion)


@lru_cache(maxsize=32)
def smooth_step(relaxation_length: float, noise: float, ds: float) -> SmoothStep:
    """Weights and noise of a step.

    Parameters
    ----------
    relaxation_length : float
        R.
    noise : float
        A = RK.
    ds : float
        h.
    """
    h, x = ds, ds / relaxation_length
    p0, p1, p2, p3 = (float(phi(k, x)) for k in range(4))
    covariance, wander, curl = _second_moments(x)
    # h K √h, of a step whose length is the unit of length.
    amplitude = noise * x * math.sqrt(h)
    root = np.linalg.cholesky(covariance) * amplitude
    root[0] /= h
    (n11, _, _), (n21, n22, _), (n31, n32, n33) = root.tolist()
    of_kappa = p0, x * p1, x * p2
    of_alpha = h * p1, h * x * p2, h * x * p3
    of_mean = h * p2, h * x * p3
    return SmoothStep(
        ds=h,
        weights=(*of_kappa, *of_alpha, *of_mean),
        noise=(n11, n21, n22, n31, n32, n33),
        spread=(0.5 * amplitude**2 * wander, 0.5 * h**2 * curl),
    )  # fmt: skip


def _second_moments(x: float) -> tuple[Array, float, float]:
    """∫ g gᵀ over a step of length one; the mean of (α(u) - ᾱ)² for K = 1, for κ = 1.

    Beyond `_FADED`/x nothing is left of e^{-xt}, and g is a polynomial.
    """
    nodes, node_weights = np.polynomial.legendre.leggauss(_N_NODES)
    split = min(1.0, _FADED / x)
    t = np.concatenate([0.5 * split * (1 + nodes),
                        split + 0.5 * (1 - split) * (1 + nodes)])  # fmt: skip
    weights = np.concatenate([0.5 * split * node_weights,
                              0.5 * (1 - split) * node_weights])  # fmt: skip
    g = np.stack([phi(0, x * t), t * phi(1, x * t), t**2 * phi(2, x * t)])
    covariance = (weights * g) @ g.T
    wander = float(weights @ ((1 - t) * g[1] ** 2) - covariance[2, 2])
    curl = float(covariance[1, 1] - phi(2, x) ** 2)
    return covariance, wander, curl
