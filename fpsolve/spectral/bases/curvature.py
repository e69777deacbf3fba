"""Operators of the curvature κ as real banded matrices."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.sparse import csc_array, diags_array

from fpsolve.model.persistence import Persistence
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.spectral.bases.weights import Weight

__all__ = ["CurvatureOperators", "curvature_degree", "curvature_operators"]


class CurvatureOperators(NamedTuple):
    """What κ does to the functions e_j = iʲ w^{1-ϑ} he_j(κ/g), j <= a degree.

    The phases iʲ make all of it real. With g² the variance of the weight, c e_j =
    i √j e_{j-1} and c† e_j = -i √(j+1) e_{j+1}: κ = g (c + c†) and
    ∂_κ = [ϑ c - (1-ϑ) c†]/g.

    Attributes
    ----------
    turning : csc_array
        i κ.
    forced : csc_array
        i ∂_κ.
    relaxing : csc_array
        -(κ/R) ∂_κ + (K²/2) ∂_κκ.
    """

    turning: csc_array
    forced: csc_array
    relaxing: csc_array


def curvature_operators(
    model: SmoothLayDownModel, weight: Weight, degree: int
) -> CurvatureOperators:
    """The operators in the basis of a degree.

    Products are formed in a larger basis, so that no neighbour is lost.
    """
    root, exponent = math.sqrt(weight.variance), weight.exponent
    # c = i down and c† = -i up.
    down = diags_array(np.sqrt(np.arange(1.0, degree + 4)), offsets=1).tocsc()
    up = down.T.tocsc()
    turning = root * (up - down)
    slope = -(exponent * down + (1.0 - exponent) * up) / root
    diffusion = -0.5 * model.curvature_noise**2 * (slope @ slope)
    relaxing = (turning @ slope) / model.relaxation_length + diffusion
    parts = (csc_array(part)[: degree + 1, : degree + 1]
             for part in (turning, slope, relaxing))  # fmt: skip
    return CurvatureOperators(*parts)


def curvature_degree(model: SmoothLayDownModel, degree: int) -> int:
    """Degree in κ for one in ξ: 0.8 of it, and a + 2√a + 2 more, a = A²R/2.

    Measured: with less the error of the moments is that of κ.
    """
    a = Persistence.of(model).bending
    return math.ceil(0.8 * degree + a + 2 * math.sqrt(a) + 2)
