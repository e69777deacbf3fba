"""The null vector of L* in Hermite polynomials and harmonics, degree by degree."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.linalg import lu_factor, lu_solve

from fpsolve._support.arrays import Array
from fpsolve.model.laydown import LayDownModel
from fpsolve.spectral.evolution.expansion import Expansion, Limits
from fpsolve.spectral.evolution.exponential import ForwardOperator

__all__ = ["Unknowns", "forward_matrix", "memory_of", "stationary", "truncation_limits"]

# Harmonics of a truncation, at least and per degree. At low noise the angle far out is
# sharp, so that high degrees need harmonics too.
FEWEST_HARMONICS, ASPECT = 16, 0.4
# Bytes of the elimination per squared size of a block: the block, its factors, and
# the block that couples it to the next.
BYTES = 4 * 8


def truncation_limits(degree: int) -> Limits:
    """Harmonics on a quarter of an ellipse over the degrees, at least one.

    Without any harmonic a degree would couple to nothing.
    """
    n = np.arange(degree + 1)
    harmonics = max(FEWEST_HARMONICS, ASPECT * degree)
    height = harmonics * np.sqrt(1.0 - (n / degree) ** 2)
    return np.maximum(1, np.rint(height)).astype(np.int64)


def memory_of(limits: Limits) -> int:
    """Bytes of the elimination."""
    sizes = (np.arange(limits.size) + 1.0) * (limits + 1.0)
    return int(BYTES * np.sum(sizes**2))


def stationary(model: LayDownModel, limits: Limits) -> Expansion:
    """The null vector within limits, its constant coefficient one.

    Reflection (ξ2, α) → (−ξ2, −α) leaves it unchanged: it is real in this basis.
    """
    index = Unknowns(limits)
    matrix = forward_matrix(model, index)
    solution = eliminate(matrix, index.offsets)
    result = Expansion.empty(limits)
    result.values[index.i, index.j, 2 * index.k] = solution
    return result


class Unknowns:
    """Real parts of d[i, j, k], sorted by degree; k = 0 only for even j."""

    def __init__(self, limits: Limits) -> None:
        i, j, k, sizes = [], [], [], []
        for n, last in enumerate(limits):
            second, harmonic = np.divmod(np.arange((n + 1) * (last + 1)), last + 1)
            kept = (harmonic > 0) | (second % 2 == 0)
            i.append(n - second[kept])
            j.append(second[kept])
            k.append(harmonic[kept])
            sizes.append(int(kept.sum()))
        self.i, self.j, self.k = map(np.concatenate, (i, j, k))
        self.offsets = np.concatenate([[0], np.cumsum(sizes)])
        m = int(limits.max()) + 2
        self._table = np.full((limits.size + 1, limits.size + 1, m), -1)
        self._table[self.i, self.j, self.k] = np.arange(self.i.size)

    def find(self, i: Limits, j: Limits, k: Limits) -> Limits:
        """Numbers of unknowns, −1 where there is none."""
        outside = (i < 0) | (j < 0) | (k < 0)
        return np.where(outside, -1, self._table[i, j, k])


def forward_matrix(model: LayDownModel, index: Unknowns) -> sparse.csr_array:
    """L* on functions that are even under (ξ2, α) → (−ξ2, −α), as a matrix."""
    scale1, scale2, diffusivity, belt = ForwardOperator(model).numbers
    i, j, k = index.i, index.j, index.k
    up1, up2 = scale1 * np.sqrt(i + 1.0), scale2 * np.sqrt(j + 1.0)
    down1, down2 = scale1 * np.sqrt(i), scale2 * np.sqrt(j)
    # Without a harmonic the two neighbours k = ±1 are one unknown.
    above = np.where(k == 0, 1.0, 0.5 * (k + 1.0))
    below = np.where(k == 0, 0.0, 0.5 * (k - 1.0))
    couplings = (
        (i, j, k, -diffusivity * k**2.0),
        (i + 1, j, k - 1, -0.5 * k * up1),
        (i + 1, j, k + 1, 0.5 * k * up1),
        (i, j + 1, k - 1, -0.5 * k * up2),
        (i, j + 1, k + 1, -0.5 * k * up2),
        (i - 1, j, k + 1, above * down1),
        (i - 1, j, k - 1, -below * down1),
        (i, j - 1, k + 1, above * down2),
        (i, j - 1, k - 1, below * down2),
        (i - 1, j, k, belt * down1),
    )
    rows, columns, values = [], [], []
    for first, second, harmonic, value in couplings:
        column = index.find(first, second, harmonic)
        kept = np.flatnonzero((column >= 0) & (value != 0))
        rows.append(kept)
        columns.append(column[kept])
        values.append(value[kept])
    where = np.concatenate(rows), np.concatenate(columns)
    n = i.size
    return sparse.csr_array((np.concatenate(values), where), shape=(n, n))


def eliminate(matrix: sparse.csr_array, offsets: NDArray[np.int64]) -> Array:
    """The null vector of a block tridiagonal matrix whose first unknown is one."""
    # Without the first unknown, which moves to the right-hand side.
    right = -matrix[1:, [0]].toarray()[:, 0]
    matrix = matrix[1:, 1:].tocsr()
    offsets = np.maximum(offsets - 1, 0)
    blocks = [slice(a, b) for a, b in pairwise(offsets)]
    factors: list[Any] = []
    carried: list[Array] = []
    for n, here in enumerate(blocks):
        # Too large a number anywhere leaves none in the solution that is one.
        if n and not np.isfinite(carried[-1]).all():
            return np.full(matrix.shape[0] + 1, np.nan)
        diagonal = matrix[here, here].toarray()
        source = right[here]
        if n:
            before = blocks[n - 1]
            lower, upper = matrix[here, before], matrix[before, here]
            diagonal -= lower @ lu_solve(factors[-1], upper.toarray())
            source = source - lower @ lu_solve(factors[-1], carried[-1])
        factors.append(lu_factor(diagonal))
        carried.append(source)
    solution = np.empty(matrix.shape[0])
    for n in range(len(blocks) - 1, -1, -1):
        source = carried[n]
        if n + 1 < len(blocks):
            source = source - matrix[blocks[n], blocks[n + 1]] @ solution[blocks[n + 1]]
        solution[blocks[n]] = lu_solve(factors[n], source)
    return np.concatenate([[1.0], solution])
