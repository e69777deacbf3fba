"""Coefficients of an initial density in sectors of the angular index."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy.special import ive

from fpsolve._kernels.lanes import LANES
from fpsolve._support.arrays import Array, Complex
from fpsolve.spectral.bases.sectors import Integers
from fpsolve.spectral.evolution.expansion import Expansion
from fpsolve.spectral.evolution.projection import DensityStart, GaussianStart
from fpsolve.spectral.evolution.sector_expansion import SectorExpansion

__all__ = ["in_sectors", "of_density", "of_gaussian", "turned", "turned_back"]

# Degrees of a Gaussian that are tried, one after another; and the last of them that
# tell how fast the rest decays.
DEGREES = tuple(32 * 3**n // 2**n for n in range(8))
LAST = 8
# At least these sectors are kept: the moments are in them.
OF_MOMENTS = 3
# So many that hold next to nothing one after another are followed by none that do: by
# symmetry every second may be empty.
IN_A_ROW, NOTHING = 4, 1e-3
# Harmonics of a von Mises density.
FEWEST_HARMONICS, MOST_HARMONICS = 2, 400


def of_gaussian(
    start: GaussianStart, neglected: float
) -> tuple[SectorExpansion, float] | None:
    """A Gaussian times von Mises, and a bound of the norm left out of every sector.

    None if the degrees that are tried do not hold it.
    """
    # Where ξ has the variance σ²(1 + R) about its mean, c falls at least as |R|^{n/2}.
    spread = float(np.abs(np.linalg.eigvalsh(start.covariance) - 1.0).max())
    likely = 2.0 * math.log(neglected) / math.log(min(max(spread, 1e-3), 1 - 1e-9))
    for degree in (n for n in DEGREES if n >= likely):
        plane = gaussian_plane(start, degree)
        size, rest = norm_and_rest(plane)
        if rest <= neglected:
            break
    else:
        return None
    harmonics = np.arange(MOST_HARMONICS + 1)
    share = ive(harmonics, start.concentration) / ive(0, start.concentration)
    left = np.sqrt(2.0 * np.cumsum(share[::-1] ** 2)[::-1]) * size
    if not left[-1] <= neglected:
        return None
    last = max(FEWEST_HARMONICS, int(np.argmax(left <= neglected)) - 1)
    k = np.arange(-last, last + 1)
    waves = share[np.abs(k)] * np.exp(-1j * k * start.angle)
    diagonals = by_angular_index(plane)

    def rows(angular: Integers) -> Complex:
        return np.asarray(diagonals[angular] * waves[:, None])

    return in_sectors(rows, degree, last, neglected), rest + float(left[last + 1])


def gaussian_plane(start: GaussianStart, degree: int) -> Complex:
    """c[a, b] = E conj e_ab(ξ/σ), zero where a + b is above the degree.

    With μ = E w, P = E (w − μ)², Q = E |w − μ|² the generating function of E e_ab is
    exp(tμ + u μ̄ + t² P/2 + u² P̄/2 + tu (Q − 1)).
    """
    covariance = start.covariance
    centre = complex(*start.mean) / math.sqrt(2.0)
    slant = complex(covariance[0, 0] - covariance[1, 1], 2.0 * covariance[0, 1]) / 2.0
    excess = (covariance[0, 0] + covariance[1, 1]) / 2.0 - 1.0
    root = np.sqrt(np.arange(degree + 2.0))
    g = np.zeros((degree + 1, degree + 1), complex)
    g[0, 0] = 1.0
    for b in range(degree):
        less = slant.conjugate() * root[b] * g[0, b - 1] if b else 0.0
        g[0, b + 1] = (centre.conjugate() * g[0, b] + less) / root[b + 1]
    for a in range(degree):
        row = centre * g[a]
        row[1:] += excess * root[1 : degree + 1] * g[a, :-1]
        if a:
            row += slant * root[a] * g[a - 1]
        g[a + 1] = row / root[a + 1]
    order = np.arange(degree + 1)
    g[np.add.outer(order, order) > degree] = 0.0
    return np.asarray(g.conj())


def norm_and_rest(plane: Complex) -> tuple[float, float]:
    """Norm of the coefficients, and of what lies beyond if it falls as the last do."""
    order = np.arange(plane.shape[0])
    degrees = np.add.outer(order, order).ravel()
    energies = np.bincount(degrees, np.abs(plane.ravel()) ** 2)[: plane.shape[0]]
    before, after = energies[-2 * LAST : -LAST].sum(), energies[-LAST:].sum()
    size = math.sqrt(energies.sum())
    if not after < before:
        return size, 0.0 if after == 0 else math.inf
    return size, math.sqrt(after * after / (before - after))


def by_angular_index(plane: Complex) -> Complex:
    """table[l, m] of c[a, b], l = a − b of either sign, m = min(a, b)."""
    degree = plane.shape[0] - 1
    angular = np.concatenate([np.arange(degree + 1), np.arange(-degree, 0)])[:, None]
    m = np.arange(degree // 2 + 1)
    a, b = m + np.maximum(angular, 0), m + np.maximum(-angular, 0)
    inside = a + b <= degree
    return np.asarray(np.where(inside, plane[a * inside, b * inside], 0.0))


def of_density(start: DensityStart, neglected: float) -> tuple[SectorExpansion, float]:
    """A density on a grid, as far as its grid resolves it."""
    expansion = start.expansion(*start.resolved)
    circles = turned(expansion)
    n_harmonics = circles.shape[2]
    # For k < 0 of a real density: c[a, b, −k] = conj c[b, a, k].
    mirrored = circles.transpose(1, 0, 2).conj()
    planes = [mirrored[:, :, k] for k in range(n_harmonics - 1, 0, -1)]
    planes += [circles[:, :, k] for k in range(n_harmonics)]
    table = np.stack([by_angular_index(plane) for plane in planes])

    def rows(angular: Integers) -> Complex:
        return np.asarray(table[np.arange(len(planes)), angular])

    last = n_harmonics - 1
    return in_sectors(rows, expansion.degree, last, neglected), 0.0


def turned(h: Expansion) -> Complex:
    """c[a, b, k] in circular Hermite functions, from products He_i He_j.

    (a + b) e_ab = √a a† e_{a−1,b} + √b b† e_{a,b−1}, with a† = (x† + i y†)/√2 and
    b† = (x† − i y†)/√2, degree by degree: these are averages, nothing grows.
    """
    degree = h.degree
    values = h.complex_values * (1j ** np.arange(degree + 1))[:, None]
    result = np.zeros_like(values)
    rotation = np.ones((1, 1), complex)
    for n in range(degree + 1):
        i = np.arange(n + 1)
        if n:
            rotation = next_rotation(rotation)
        result[i, n - i] = rotation.conj() @ values[i, n - i]
    return result


def turned_back(circles: Complex) -> Expansion:
    """The inverse of `turned`."""
    degree, harmonics = circles.shape[0] - 1, circles.shape[2] - 1
    result = Expansion.empty(np.full(degree + 1, harmonics))
    values = np.zeros_like(circles)
    rotation = np.ones((1, 1), complex)
    for n in range(degree + 1):
        i = np.arange(n + 1)
        if n:
            rotation = next_rotation(rotation)
        values[i, n - i] = rotation.T @ circles[i, n - i]
    values *= ((-1j) ** np.arange(degree + 1))[:, None]
    result.values[:-1, :-1, :-2] = values.view(np.float64)
    result.clear_outside()
    return result


def next_rotation(rotation: Complex) -> Complex:
    """e_ab over He_i He_j of one more degree n: [a, i], b = n − a and j = n − i."""
    n = rotation.shape[0]
    root = np.sqrt(np.arange(1.0, n + 1))
    along, across = (np.zeros((n, n + 1), complex) for _ in range(2))
    along[:, 1:] = rotation * root
    across[:, :-1] = 1j * rotation * root[::-1]
    result = np.zeros((n + 1, n + 1), complex)
    result[1:] += root[:, None] * (along + across)
    result[:-1] += root[::-1, None] * (along - across)
    return np.asarray(result / (n * math.sqrt(2.0)))


def in_sectors(
    rows: Callable[[Integers], Complex], degree: int, harmonics: int, neglected: float
) -> SectorExpansion:
    """The sectors M ≥ 0 but the last, which hold less than what may be neglected.

    rows(l) are the coefficients of k = −K … K at the angular indices l = M − k.
    """
    k = np.arange(-harmonics, harmonics + 1)
    found: list[Complex] = []
    norms: list[float] = []
    for index in range(degree + harmonics + 1):
        angular = index - k
        inside = np.abs(angular) <= degree
        found.append(np.where(inside[:, None], rows(angular * inside), 0.0))
        norms.append(float(np.linalg.norm(found[-1])))
        if index > OF_MOMENTS and max(norms[-IN_A_ROW:]) <= NOTHING * neglected:
            break
    beyond = np.sqrt(2.0 * np.cumsum(np.square(norms)[::-1])[::-1])
    n_sectors = max(OF_MOMENTS, int(np.count_nonzero(beyond > neglected)))
    values = tuple(framed(one) for one in found[:n_sectors])
    counts = []
    for one in values:
        counts.append(np.zeros(one.shape[1], np.int64))
        counts[-1][1:-1] = one.shape[2] - LANES
    return SectorExpansion(values, tuple(counts))


def framed(rows: Complex) -> Array:
    """Re and Im with empty rows and places around, in whole registers."""
    n, width = rows.shape
    result = np.zeros((2, n + 2, -(-width // LANES) * LANES + LANES))
    result[0, 1:-1, 1 : width + 1] = rows.real
    result[1, 1:-1, 1 : width + 1] = rows.imag
    return result
