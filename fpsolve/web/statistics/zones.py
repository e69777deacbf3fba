"""How much the mass of square zones varies."""

from __future__ import annotations

from typing import Any

import numpy as np

from fpsolve._support.arrays import Array, check_finite_numbers
from fpsolve._support.checks import check_positive
from fpsolve.web.statistics.estimate import Estimate, Estimates
from fpsolve.web.statistics.fields import check_density
from fpsolve.web.statistics.jackknife import estimate

__all__ = [
    "check_zone",
    "coefficient_of_variation",
    "mean_density",
    "measured_zones",
    "relative_variance",
    "zone_means",
]

# Relative; what rounding makes of the number of zones, and of an edge of zones that is
# one of pixels.
_ROUNDING, _EDGE = 1e-9, 1e-12


def coefficient_of_variation(
    length_density: Any, pixel: float, zone: Any, *, block: float | None = None
) -> Estimate | Estimates:
    """CV(x) = (⟨m_z²⟩ - ⟨m_z⟩²)^½ / ⟨m_z⟩ over the square zones z of side x.

    Zones lie side by side from the first pixel on; what remains at the far edges is
    left out. A pixel that a zone cuts counts by its area inside, exact for a density
    that is constant in each pixel. The variance is that of the zones at hand (divided
    by their number). The standard error comes from leaving out one block of zones at a
    time, blocks being longer than the correlation length, and includes the bias of a
    finite web.

    Parameters
    ----------
    length_density : array
        Laid length per area, cross × machine direction.
    pixel : float
        Side of a pixel.
    zone : float or sequence of float
        Side x of a zone, or many, at least the pixel and at most the web.
    block : float, optional
        Side of the blocks; by default two correlation lengths of the influence that
        zones have on CV, or more where 16 blocks fit.

    Returns
    -------
    Estimate or Estimates
        CV with `standard_error`, `n_blocks` and `n_samples`, the number of zones; over
        the zones for a sequence of them.

    Raises
    ------
    TypeError
        If an argument is no real number.
    ValueError
        For NaN, negative or no mass, a zone below the pixel or larger than the web, or
        fewer than two zones.
    """
    if np.ndim(zone) == 0:
        return _variation(length_density, pixel, zone, block)
    zones = check_finite_numbers("zone", zone)
    if zones.ndim != 1 or zones.size == 0:
        raise ValueError(
            f"`zone` must be a number or a list of them, got shape {zones.shape}."
        )
    return Estimates.of(
        zones, [_variation(length_density, pixel, one, block) for one in zones]
    )


def mean_density(
    length_density: Any, pixel: float, *, block: float | None = None
) -> Estimate:
    """⟨m⟩, mean length per area of the whole web; 1/(v d) is expected.

    Parameters
    ----------
    length_density, pixel, block
        As for `coefficient_of_variation`.

    Returns
    -------
    Estimate
    """
    density, pixel = check_density(length_density, pixel)
    return estimate(lambda means: means[..., 0], [density], pixel, block)


def zone_means(density: Array, pixel: float, zone: float) -> Array:
    """Return the mean of every whole zone, cross × machine direction."""
    return _strip_means(_strip_means(density, zone / pixel).T, zone / pixel).T


def measured_zones(
    length_density: Any, pixel: Any, zone: Any
) -> tuple[float, list[Array]]:
    """Return the side of the zones, and what `relative_variance` asks of them."""
    density, pixel = check_density(length_density, pixel)
    side = check_zone(zone, pixel, density.shape)
    means = zone_means(density, pixel, side)
    shift = float(means.mean())
    centred = means - shift
    return side, [centred, centred**2, np.full(means.shape, shift)]


def relative_variance(means: Array) -> Array:
    """CV² from ⟨m - c⟩, ⟨(m - c)²⟩ and c on the last axis; c keeps the digits."""
    mean, square, shift = means[..., 0], means[..., 1], means[..., 2]
    return np.asarray(np.maximum(square - mean**2, 0.0) / (mean + shift) ** 2)


def check_zone(zone: Any, pixel: float, shape: tuple[int, int]) -> float:
    """Return the side of a zone; ValueError unless two fit that hold a pixel."""
    side = check_positive("zone", zone)
    if not side >= pixel * (1.0 - _ROUNDING):
        raise ValueError(
            f"`zone` must be at least the pixel, {pixel:g}, got {side:g}; lay the web "
            "with smaller pixels."
        )
    counts = [_count(n, side / pixel) for n in shape]
    if not (counts[0] * counts[1] >= 2):
        width, length = (n * pixel for n in shape)
        raise ValueError(
            f"`zone` must fit at least twice into the web of {width:g} × {length:g}, "
            f"got {side:g}; lay a larger web."
        )
    return side


def _variation(
    length_density: Any, pixel: float, zone: Any, block: float | None
) -> Estimate:
    side, fields = measured_zones(length_density, pixel, zone)
    return _root(estimate(relative_variance, fields, side, block))


def _root(square: Estimate) -> Estimate:
    """Return the root of a square; where that is lost in its error, the error's."""
    root, error = float(np.sqrt(square)), square.standard_error
    # Of equal zones both are zero; where the error is not known, it stays NaN.
    if error != 0.0:
        error /= np.maximum(2.0 * root, np.sqrt(error))
    return Estimate(root, error, square.n_blocks, square.n_samples, square.reason)


def _strip_means(density: Array, ratio: float) -> Array:
    """Return means over intervals of the first axis, `ratio` pixels long."""
    n = density.shape[0]
    edges = np.minimum(ratio * np.arange(_count(n, ratio) + 1), n)
    whole = np.rint(edges)
    edges = np.where(np.abs(edges - whole) <= _EDGE * n, whole, edges)
    below = np.minimum(edges.astype(np.int64), n - 1)
    sums = np.zeros((n + 1, density.shape[1]))
    np.cumsum(density, axis=0, out=sums[1:])
    at_edges = sums[below] + (edges - below)[:, None] * density[below]
    return np.asarray(np.diff(at_edges, axis=0) / ratio)


def _count(n: int, ratio: float) -> int:
    """Return how many intervals of `ratio` pixels fit into n of them."""
    return int(n / ratio * (1.0 + _ROUNDING))
