"""Plane waves in the basis of a smooth fibre, and its stationary law of them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array, Complex
from fpsolve.spectral.resolvent.plane_waves import WaveVector, between
from fpsolve.spectral.resolvent.smooth_generator import (
    SmoothGenerator,
    hermite_of_wave,
)

__all__ = [
    "angle_moments",
    "characteristic",
    "characteristic_changes",
    "multiplied",
    "plane_wave",
    "position_variances",
]


def plane_wave(generator: SmoothGenerator, k: WaveVector) -> Complex:
    """Coefficients of e^{ik·(ξ − c)}."""
    place, degree = generator.placement, generator.basis.degree
    along, across = (
        hermite_of_wave(one * width, degree, place.exponent)
        for one, width in zip(k, place.widths, strict=True)
    )
    return np.asarray(generator.function(along, across, generator.constant(2)))


def characteristic(generator: SmoothGenerator, k: WaveVector) -> complex:
    """E e^{ik·(ξ − c)} in the stationary law."""
    return complex(generator.stationary @ plane_wave(generator, k))


def characteristic_changes(generator: SmoothGenerator, k2: float) -> Array:
    """φ(0, k2) and its derivatives, in the parameters and last in k2.

    Of c_m(q) = ∫ e^{iqx} … he_m the derivative is i (√(m+1) c_{m+1} + √m c_{m−1}).
    """
    place, degree = generator.placement, generator.basis.degree
    along, on_curvature = generator.constant(0), generator.constant(2)
    _, width = place.widths
    longer = hermite_of_wave(k2 * width, degree + 1, place.exponent)
    roots = np.sqrt(np.arange(1.0, degree + 2))
    slopes = 1j * width * roots * longer[1:]
    slopes[1:] += 1j * width * roots[:-1] * longer[:degree]
    wave, by_k = (
        generator.function(along, across, on_curvature)
        for across in (longer[:-1], slopes)
    )
    p = generator.stationary
    changes = generator.stationary_derivatives @ wave
    return np.array([p @ wave, *changes, p @ by_k]).real


def multiplied(generator: SmoothGenerator, p: NDArray[Any], k: WaveVector) -> Complex:
    """E e^{−ik·(ξ − c)} f in the law p, for every state f of the basis."""
    basis = generator.basis
    along, across = (
        between(-one * width, basis.degree)
        for one, width in zip(k, generator.placement.widths, strict=True)
    )
    table = np.tensordot(along, basis.table(p), axes=1)
    table = np.swapaxes(np.tensordot(across, table, axes=(1, 1)), 0, 1)
    return np.asarray(basis.picked(table))


def angle_moments(
    generator: SmoothGenerator, power: int, law: Array | None = None
) -> Array:
    """E κ^power cos kα in the stationary law, k = 0, 1, …, for an even power.

    Or of another `law`, a derivative of it, say.
    """
    basis = generator.basis
    curvature = generator.constant(2)
    for _ in range(power):
        curvature = generator.curvatures @ curvature
    table = basis.table(generator.stationary if law is None else law)
    along, across = generator.constant(0), generator.constant(1)
    moments = np.einsum("mnaj,m,n,j->a", table, along, across, curvature, optimize=True)
    cosine = basis.flat.circle[1]
    found = moments[cosine] / np.where(np.arange(cosine.sum()) > 0, np.sqrt(2.0), 1.0)
    return np.asarray(found)


def position_variances(generator: SmoothGenerator) -> tuple[float, float, float]:
    """E ξ1, Var ξ1 and Var ξ2 in the stationary law."""
    place, table = generator.placement, generator.basis.table(generator.stationary)
    curvature = generator.constant(2)
    plain = np.einsum("mnj,j->mn", table[:, :, 0], curvature)
    one = generator.constant(0)
    x = np.sqrt(np.arange(1.0, one.size))
    times = np.diag(x, 1) + np.diag(x, -1)
    powers = [one, times @ one, times @ times @ one]
    mean, along, across = (
        float(powers[i] @ plain @ powers[j]) for i, j in ((1, 0), (2, 0), (0, 2))
    )
    width1, width2 = place.widths
    return (
        place.centre + width1 * mean,
        width1**2 * (along - mean**2),
        width2**2 * across,
    )
