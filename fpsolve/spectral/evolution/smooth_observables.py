"""Polynomials of ξ, κ and e^{iα} in circular functions, and the moments they give."""

from __future__ import annotations

import math

import numpy as np

from fpsolve._support.arrays import Array, Complex
from fpsolve.grids.smooth_sums import SMOOTH_MOMENTS
from fpsolve.spectral.evolution.circular_functions import CircularFunctions

__all__ = ["SERIES", "observables", "series_of"]

SERIES = ("mass", *SMOOTH_MOMENTS)
# 1, z, e^{iα}, |z|², z², κ, κ² with z = ξ₁/σ₁ + iξ₂/σ₂: powers of z, z̄ and κ, and the
# harmonic of α.
OBSERVABLES = (
    (0, 0, 0, 0), (1, 0, 0, 0), (0, 0, 0, 1), (1, 1, 0, 0), (2, 0, 0, 0),
    (0, 0, 1, 0), (0, 0, 2, 0),
)  # fmt: skip
HIGHEST = 2


def observables(functions: CircularFunctions) -> Complex:
    """A row of coefficients c with f = Σ c_j ψ_j for each observable f."""
    return np.array([coefficients(functions, *powers) for powers in OBSERVABLES])


def series_of(rows: Complex, sigma: tuple[float, float]) -> tuple[Array, ...]:
    """`SERIES` from the expectations of the observables, one row for every s."""
    sigma1, sigma2 = sigma
    mass, z, turned, norm, square, kappa, kappa2 = rows.T
    second, away = norm.real, square - z * z
    spread = second - np.abs(z) ** 2
    return (
        mass.real, sigma1 * z.real, sigma2 * z.imag,
        0.5 * sigma1**2 * (spread + away.real), 0.5 * sigma2**2 * (spread - away.real),
        0.5 * sigma1 * sigma2 * away.imag,
        turned.real, turned.imag, kappa.real, kappa2.real,
    )  # fmt: skip


def coefficients(
    functions: CircularFunctions, a: int, b: int, c: int, harmonic: int
) -> Complex:
    """Of z^a z̄^b κ^c e^{i harmonic α}: 1 divided by the weight, and multiplied."""
    t, scales = functions.truncation, functions.scales
    p, q, n, _ = functions.indices
    # Under w^ϑ the ratio of variances to that of w is 1/ϑ.
    excess = 1.0 / scales.plane_share - 1.0
    h = np.diag(excess ** np.arange(t.degree + 1 + HIGHEST)) / scales.plane_share
    width = math.sqrt(2.0 * scales.plane)
    for _ in range(a):
        h = width * multiplied(h)
    for _ in range(b):
        h = width * multiplied(h.T).T
    kappa = powers_of_curvature(t.curvature, c, functions)[n] * (-1j) ** (n % 4)
    return np.where(functions.harmonics == harmonic, h[p, q] * kappa, 0.0)


def multiplied(h: Array) -> Array:
    """z/√(2S²) times Σ h_pq: p goes up, or q goes down."""
    root = np.sqrt(np.arange(1.0, h.shape[0]))
    product = np.zeros_like(h)
    product[1:] = root[:, None] * h[:-1]
    product[:, :-1] += root * h[:, 1:]
    return product


def powers_of_curvature(degree: int, power: int, functions: CircularFunctions) -> Array:
    """κ^power in v^{1−θ} He_n(κ/g)."""
    share = functions.scales.curvature_share
    found = np.zeros(degree + 1 + HIGHEST)
    found[0] = 1.0 / math.sqrt(share)
    for n in range(2, found.size, 2):
        found[n] = found[n - 2] * (1.0 / share - 1.0) * math.sqrt((n - 1) / n)
    root = np.sqrt(np.arange(1.0, found.size))
    for _ in range(power):
        up, down = np.append(0.0, root * found[:-1]), np.append(root * found[1:], 0.0)
        found = math.sqrt(functions.scales.curvature) * (up + down)
    return found
