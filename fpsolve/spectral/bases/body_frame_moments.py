"""Moments of a density in the frame of a smooth fibre, from its coefficients."""

from __future__ import annotations

import math

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.grids.smooth_sums import SMOOTH_MOMENTS
from fpsolve.spectral.bases.weights import Weight

__all__ = ["body_frame_moments", "curvature_integrals"]


def body_frame_moments(
    table: Array, position: Weight, curvature: Weight
) -> dict[str, float]:
    """Mass and moments of Σ table[n_a, n_b, j] conj(e), per unit of pairing.

    Only n_a = n_b counts, and j even. The radial function m is (-1)^m L_m(x) e^{-ϑx}
    with x = ‖ξ‖²/(2S²), relative to e^{-x}: ∫ is qᵐ/ϑ, q = (1 - ϑ)/ϑ, and one with a
    factor x follows from its three-term recurrence. By symmetry all first moments and
    the covariance are 0, and both variances are E ‖ξ‖²/2.

    Parameters
    ----------
    table : ndarray, shape (degree + 1, degree + 1, curvature + 1)
        Real.
    position, curvature : Weight
        Those of densities.
    """
    number = np.arange((table.shape[0] + 1) // 2)
    diagonal = table[number, number]
    zeroth, second = curvature_integrals(table.shape[2] - 1, curvature)
    q, exponent = (1 - position.exponent) / position.exponent, position.exponent
    plane = q**number / exponent
    square = ((number + 1) * q + (2 * number + 1)) * plane
    square[1:] += number[1:] * plane[:-1]
    mass = float(plane @ diagonal @ zeroth)
    moments = dict.fromkeys(SMOOTH_MOMENTS, 0.0)
    variance = position.variance * float(square @ diagonal @ zeroth) / mass
    moments["variance_xi1"] = moments["variance_xi2"] = variance
    moments["mean_kappa2"] = float(plane @ diagonal @ second) / mass
    return {"mass": mass, **moments}


def curvature_integrals(degree: int, weight: Weight) -> tuple[Array, Array]:
    """∫ (-i)ʲ he_j(κ/g) φ^ϑ dκ, and with a factor κ², over ∫ φ; j <= degree.

    φ^ϑ is a Gaussian of variance 1/ϑ in units of g, so that the integrals I_j of he_j
    vanish for odd j and I_j = q √((j-1)/j) I_{j-2}, q = (1 - ϑ)/ϑ, I_0 = 1/√ϑ. With
    κ² = g² (c + c†)² those of κ² he_j are sums of three of them.
    """
    q = (1 - weight.exponent) / weight.exponent
    integrals = np.zeros(degree + 3)
    integrals[0] = 1 / math.sqrt(weight.exponent)
    for even in range(2, degree + 3, 2):
        integrals[even] = q * math.sqrt((even - 1) / even) * integrals[even - 2]
    j = np.arange(degree + 1)
    lower = np.concatenate([[0.0, 0.0], integrals[: degree + 1]])[: degree + 1]
    squares = np.sqrt(j * np.maximum(j - 1, 0)) * lower
    squares += (2 * j + 1) * integrals[:-2]
    squares += np.sqrt((j + 1) * (j + 2)) * integrals[2:]
    # (-i)ʲ of even j; odd ones vanish.
    sign = np.where(j % 4 == 2, -1.0, 1.0)
    return sign * integrals[:-2], weight.variance * sign * squares
