"""A density under an isotropic force, in sectors of the angular index."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fpsolve._kernels.lanes import LANES
from fpsolve._support.arrays import Array
from fpsolve.grids.row_sums import MOMENTS
from fpsolve.spectral.evolution.expansion import Limits

__all__ = ["SectorExpansion", "moments"]

Flags = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class SectorExpansion:
    """p/p_S = Σ c[k, a, b] e_ab(ξ/σ) e^{ikα}, orthonormal in L²(μ), by M = a − b + k.

    e_ab are the circular Hermite functions of the angular index l = a − b, the leading
    term of which is w^a w̄^b/√(a! b!), w = (ξ1 + iξ2)/(√2 σ). Only M ≥ 0 is held, since
    p is real.

    Attributes
    ----------
    values : tuple of ndarray, shape (2, 2K + 3, .)
        Of each sector Re and Im at [part, k + K + 1, 1 + min(a, b)]; zero outside the
        counts.
    counts : tuple of ndarray of int, shape (2K + 3,)
        How many are held in every row, a multiple of four; none in the outer ones.
    """

    values: tuple[Array, ...]
    counts: tuple[Limits, ...]

    @property
    def degree(self) -> int:
        """Largest degree a + b."""
        return max(
            int(np.max(2 * (counts[held] - 1) + np.abs(index - k[held]), initial=0))
            for index, (k, counts, held) in enumerate(map(_rows, self.counts))
        )

    @property
    def harmonics(self) -> int:
        """Largest |k|."""
        return max(
            int(np.abs(k[held]).max(initial=0))
            for k, _, held in map(_rows, self.counts)
        )

    def packed(self) -> Array:
        """What is held, sector by sector, Re of all before Im."""
        parts = [
            values[:, _held(counts, values.shape[2])].ravel()
            for values, counts in zip(self.values, self.counts, strict=True)
        ]
        return np.concatenate(parts)

    @classmethod
    def unpacked(cls, counts: tuple[Limits, ...], packed: Array) -> SectorExpansion:
        """The expansion whose `packed` values these are."""
        values = []
        for one in counts:
            size, width = 2 * int(one.sum()), int(one.max()) + LANES
            here = np.zeros((2, one.size, width))
            here[:, _held(one, width)] = packed[:size].reshape(2, -1)
            values.append(here)
            packed = packed[size:]
        return cls(tuple(values), counts)

    def at(self, index: int, k: int, m: int) -> complex:
        """The coefficient of M, k and min(a, b)."""
        values, counts = self.values[index], self.counts[index]
        row = k + (counts.size - 3) // 2 + 1
        if not (0 < row < counts.size - 1 and m < counts[row]):
            return 0.0
        return complex(*values[:, row, 1 + m])


def _rows(counts: Limits) -> tuple[Limits, Limits, Flags]:
    """The harmonic of every row, the counts, and which rows hold any."""
    k = np.arange(counts.size) - (counts.size - 3) // 2 - 1
    return np.asarray(k, np.int64), counts, counts > 0


def _held(counts: Limits, width: int) -> Flags:
    m = np.arange(width) - 1
    return np.asarray((m >= 0) & (m < counts[:, None]))


def moments(
    h: SectorExpansion, errors: Array, sigma: float
) -> tuple[dict[str, float], dict[str, float]]:
    """E ξ, the covariance of ξ, E cos α and E sin α, and bounds of their errors.

    Seven coefficients of the sectors 0, 1 and 2, each wrong by no more than its sector.
    """
    first, second, size = h.at(1, 0, 0), h.at(2, 0, 0), h.at(0, 0, 1).real
    direction = h.at(1, 1, 0)
    in_0, in_1, in_2 = errors[:3]
    root = np.sqrt(2.0)
    mean = root * np.conj(first)
    of_mean = root * in_1
    squares = 1.0 + size + root * second.real, 1.0 + size - root * second.real
    product = -root * second.imag
    of_square = in_0 + root * in_2
    values = (
        sigma * mean.real,
        sigma * mean.imag,
        sigma**2 * (squares[0] - mean.real**2),
        sigma**2 * (squares[1] - mean.imag**2),
        sigma**2 * (product - mean.real * mean.imag),
        direction.real,
        -direction.imag,
    )
    spread1, spread2 = 2 * abs(mean.real) + of_mean, 2 * abs(mean.imag) + of_mean
    bounds = (
        sigma * of_mean,
        sigma * of_mean,
        sigma**2 * (of_square + spread1 * of_mean),
        sigma**2 * (of_square + spread2 * of_mean),
        sigma**2 * (root * in_2 + 0.5 * (spread1 + spread2) * of_mean),
        in_1,
        in_1,
    )
    # Adding zero turns a negative zero into a plain one.
    found = {name: float(v) + 0.0 for name, v in zip(MOMENTS, values, strict=True)}
    return found, {name: float(v) for name, v in zip(MOMENTS, bounds, strict=True)}
