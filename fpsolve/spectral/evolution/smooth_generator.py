"""The backward generator of the smooth model between circular functions."""

from __future__ import annotations

import math

import numpy as np
import scipy.sparse as sparse

from fpsolve._support.arrays import Array
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.spectral.evolution.circular_functions import (
    CircularFunctions,
    Indices,
    Scales,
)
from fpsolve.spectral.evolution.quadratic import quadratic

__all__ = ["backward_generator", "by_parity"]

Move = tuple[int, int, int, int]
# Degrees of κ beyond the truncation, so that products of two matrices are right in it.
BEYOND = 4


class Terms:
    """A matrix as a sum of moves, each from a function to one beside it."""

    def __init__(self, functions: CircularFunctions) -> None:
        self.functions = functions
        self.rows: list[Indices] = []
        self.columns: list[Indices] = []
        self.values: list[Array] = []

    def add(self, move: Move, values: Array) -> None:
        """Take every function to the one at its indices + move, times a value."""
        target = self.functions.moved(move)
        kept = np.flatnonzero((target >= 0) & (values != 0))
        self.rows.append(target[kept])
        self.columns.append(kept)
        self.values.append(values[kept])

    def matrix(self) -> sparse.csr_array:
        """The sum."""
        n = self.functions.size
        places = np.concatenate(self.rows), np.concatenate(self.columns)
        entries = np.concatenate(self.values)
        return sparse.csr_array((entries, places), shape=(n, n))


def backward_generator(
    functions: CircularFunctions, model: SmoothLayDownModel
) -> sparse.csr_array:
    """Matrix G, real, with L ψ_j = Σ_i G_ij ψ_i up to what lies outside.

    With z = ξ₁/σ₁ + iξ₂/σ₂, a ± b = 1/σ₁, 1/σ₂, w = a e^{iα} + b e^{−iα} + v/σ₁ and
    f = (a z + b z̄) e^{−iα}: L = w ∂_z + w̄ ∂_z̄ + κ ∂_α − (κ + ℑf) ∂_κ/R +
    (K²/2) ∂_κκ. The phases iⁿ make it real, b and v couple sectors.
    """
    terms = Terms(functions)
    add_motion(terms, model)
    kappa, derivative, relaxation = curvature_matrices(
        functions.truncation.curvature, functions.scales, model
    )
    n = functions.indices[2]
    for dn in (-1, 1):
        terms.add((0, 0, dn, 0), functions.harmonics * band(kappa, n, dn))
        add_force(terms, model, dn, -band(derivative, n, dn))
    for dn in (-2, 0, 2):
        terms.add((0, 0, dn, 0), band(relaxation, n, dn))
    return terms.matrix()


def stiffness(model: SmoothLayDownModel) -> tuple[float, float]:
    """a and b with a ± b = 1/σ₁, 1/σ₂."""
    potential = quadratic(model)
    sum_, difference = (
        1.0 / potential.sigma1 + sign / potential.sigma2 for sign in (1, -1)
    )
    return 0.5 * sum_, 0.5 * difference


def add_motion(terms: Terms, model: SmoothLayDownModel) -> None:
    """w ∂_z + w̄ ∂_z̄; under the weight each derivative has two parts."""
    (a, b), belt = stiffness(model), model.belt_speed / quadratic(model).sigma1
    p, q = terms.functions.indices[:2]
    scales = terms.functions.scales
    slope = 1.0 / math.sqrt(2.0 * scales.plane)
    falling, rising = scales.plane_share * slope, (scales.plane_share - 1.0) * slope
    parts = (
        ((-1, 0), falling * np.sqrt(p), -1), ((0, 1), rising * np.sqrt(q + 1.0), -1),
        ((0, -1), falling * np.sqrt(q), 1), ((1, 0), rising * np.sqrt(p + 1.0), 1),
    )  # fmt: skip
    for (dp, dq), values, turned in parts:
        terms.add((dp, dq, 0, 0), a * values)
        # Without e^{±iα}, or with the other one, the total index changes.
        terms.add((dp, dq, 0, turned), belt * values)
        terms.add((dp, dq, 0, 2 * turned), b * values)


def add_force(
    terms: Terms, model: SmoothLayDownModel, dn: int, derivative: Array
) -> None:
    """−ℑf ∂_κ/R with 2i ℑf = (a z + b z̄) e^{−iα} − (a z̄ + b z) e^{iα}."""
    a, b = stiffness(model)
    p, q = terms.functions.indices[:2]
    width = math.sqrt(2.0 * terms.functions.scales.plane)
    push = width / (2.0 * model.relaxation_length) * derivative
    z = (((1, 0), np.sqrt(p + 1.0)), ((0, -1), np.sqrt(q)))
    conjugate = (((0, 1), np.sqrt(q + 1.0)), ((-1, 0), np.sqrt(p)))
    for sign, parts in ((1, z), (-1, conjugate)):
        for (dp, dq), root in parts:
            terms.add((dp, dq, dn, 0), sign * a * push * root)
            terms.add((dp, dq, dn, 2 * sign), -sign * b * push * root)


def curvature_matrices(
    degree: int, scales: Scales, model: SmoothLayDownModel
) -> tuple[Array, Array, Array]:
    """iκ, ∂_κ/i and −κ ∂_κ/R + (K²/2) ∂_κκ between the iⁿ v^{1−θ} He_n: real."""
    m = np.arange(degree + 1 + BEYOND)
    root, width = np.sqrt(m[1:]), math.sqrt(scales.curvature)
    share = scales.curvature_share
    down, up = np.diag(root, 1), np.diag(root, -1)
    kappa = width * (up + down)
    derivative = (share * down - (1.0 - share) * up) / width
    noise = 0.5 * model.curvature_noise**2
    relaxation = noise * derivative @ derivative
    relaxation -= kappa @ derivative / model.relaxation_length
    # i^{column − row} is ±i beside the diagonal and −1 at distance two.
    away = m[None, :] - m[:, None]
    sign = np.sign(away)
    return -sign * kappa, sign * derivative, np.where(away % 4 == 2, -1, 1) * relaxation


def band(matrix: Array, n: Indices, dn: int) -> Array:
    """matrix[n + dn, n], and zero where n + dn is negative."""
    return np.where(n + dn >= 0, matrix[np.maximum(n + dn, 0), n], 0.0)


def by_parity(functions: CircularFunctions) -> tuple[sparse.csr_array, ...]:
    """Orthonormal columns that span the vectors even and odd under the reflection.

    Of a real density the real parts of the coefficients are even and the imaginary
    parts odd, and the generator leaves both as they are: each is half as many numbers.
    """
    mirror, sign = functions.reflected, 1.0 - 2.0 * (functions.indices[2] % 2)
    first = np.flatnonzero(mirror >= np.arange(functions.size))
    found = []
    for parity in (1.0, -1.0):
        alone = mirror[first] == first
        # A function that is its own mirror image has one parity only.
        kept = first[~alone | (sign[first] == parity)]
        pairs = np.flatnonzero(mirror[kept] != kept)
        values = np.ones(kept.size)
        values[pairs] = math.sqrt(0.5)
        entries = np.concatenate([values, parity * sign[kept[pairs]] * values[pairs]])
        rows = np.concatenate([kept, mirror[kept[pairs]]])
        columns = np.concatenate([np.arange(kept.size), pairs])
        shape = functions.size, kept.size
        found.append(sparse.csr_array((entries, (rows, columns)), shape=shape))
    return tuple(found)
