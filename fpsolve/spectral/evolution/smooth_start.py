"""A Gaussian in ξ times von Mises times the Gaussian of κ, in circular functions."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.special import ive

from fpsolve._support.arrays import Array, Complex
from fpsolve.grids.initial import checked_covariance
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.spectral.evolution.circular_functions import CircularFunctions
from fpsolve.spectral.evolution.quadratic import quadratic

__all__ = ["check_law", "expectations", "scaled"]

Gaussian = tuple[Array, Array]


def check_law(p0: Any) -> None:
    """TypeError unless the start is a law whose coefficients are known."""
    if not all(hasattr(p0, name) for name in ("mean", "variance", "concentration")):
        raise TypeError(
            "`p0` must be a GaussianLaw for a SmoothLayDownModel, got "
            f"{type(p0).__name__}; use `solve` for a density on a grid and "
            "`sample_paths` for other laws."
        )


def expectations(
    functions: CircularFunctions, law: Any, model: SmoothLayDownModel
) -> Complex:
    """E ψ of every function, κ being independent, and Gaussian of variance K²R/2."""
    t, scales = functions.truncation, functions.scales
    p, q, n, _ = functions.indices
    k = functions.harmonics
    concentration = float(law.concentration)
    waves = ive(np.abs(k), concentration) / ive(0, concentration)
    turned = waves * np.exp(1j * k * float(law.angle or 0.0))
    plane = in_plane(t.degree, scaled(law, model), scales.plane, scales.plane_share)
    share = scales.curvature_share
    kappa = in_curvature(t.curvature, model.curvature_variance, scales.curvature, share)
    return np.asarray(plane[p, q] * turned * kappa[n] * 1j ** (n % 4))


def scaled(law: Any, model: SmoothLayDownModel) -> Gaussian:
    """Mean and covariance of (ξ₁/σ₁, ξ₂/σ₂)."""
    sigma = np.array([quadratic(model).sigma1, quadratic(model).sigma2])
    covariance = checked_covariance(law.variance) / np.outer(sigma, sigma)
    return np.asarray(law.mean, float) / sigma, covariance


def in_plane(degree: int, law: Gaussian, weight: float, share: float) -> Complex:
    """E w^{1−ϑ} h_pq: of the Gaussian that is their product, times its mass.

    With m = E z/√(2S²) of that one and its covariance C in these units,
    √p h_pq = m h_{p−1,q} + √(p−1) (C₁₁ − C₂₂ + 2iC₁₂) h_{p−2,q} +
    √q (C₁₁ + C₂₂ − 1) h_{p−1,q−1}, and conjugate for q.
    """
    mass, mean, covariance = weighted(law, (1.0 - share) / weight)
    m = complex(*mean) / math.sqrt(2.0 * weight)
    (c11, c12), (_, c22) = covariance / (2.0 * weight)
    squared, mixed = complex(c11 - c22, 2.0 * c12), c11 + c22 - 1.0
    root = np.sqrt(np.arange(degree + 2.0))
    h = np.zeros((degree + 1, degree + 1), complex)
    h[0, 0] = mass
    for q in range(degree):
        less = np.conj(squared) * root[q] * h[0, q - 1] if q else 0.0
        h[0, q + 1] = (np.conj(m) * h[0, q] + less) / root[q + 1]
    for p in range(degree):
        row = m * h[p]
        row[1:] += mixed * root[1 : degree + 1] * h[p, :-1]
        if p:
            row += squared * root[p] * h[p - 1]
        h[p + 1] = row / root[p + 1]
    return h


def weighted(law: Gaussian, sharpness: float) -> tuple[float, Array, Array]:
    """Mass, mean and covariance of a Gaussian times e^{−sharpness |ξ|²/2}."""
    mean, covariance = law
    precision = np.linalg.inv(covariance)
    narrowed = np.linalg.inv(precision + sharpness * np.eye(2))
    moved = narrowed @ precision @ mean
    exponent = sharpness * float(mean @ moved)
    ratio = float(np.linalg.det(narrowed) / np.linalg.det(covariance))
    mass = math.sqrt(ratio) * math.exp(-0.5 * exponent)
    return mass, np.asarray(moved, float), np.asarray(narrowed, float)


def in_curvature(degree: int, variance: float, weight: float, share: float) -> Array:
    """E v^{1−θ} He_n(κ/g) of a centred Gaussian."""
    narrowed = 1.0 / (1.0 / variance + (1.0 - share) / weight)
    found = np.zeros(degree + 1)
    found[0] = math.sqrt(narrowed / variance)
    for n in range(2, degree + 1, 2):
        found[n] = found[n - 2] * (narrowed / weight - 1.0) * math.sqrt((n - 1) / n)
    return found
