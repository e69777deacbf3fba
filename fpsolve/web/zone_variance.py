"""The variance of square zones: Ŝ times the window of the zone, over all k."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache, partial

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.web.even import EvenNodes
from fpsolve.web.table import AXES, Axis, SpectrumTable

__all__ = ["window_integrals", "zone_variance"]

# Nodes of Gauss per period of the window.
PER_PERIOD, SPARE = 10, 8
# Nodes of Chebyshev in a rectangle outside, where Ŝ is known between them.
N_OUTSIDE = 16
# Rectangles go on until k x and k σ are beyond these numbers: of short waves a share
# of 0.2/(k x)² is left, and for wide zones one of 1/(k σ)².
FAR_PERIODS, FAR_SCALES = 1000.0, 200.0
# Of one zone all rows: Ŝ, its derivatives and estimates of errors share them.
ROWS = 128


@dataclass(frozen=True)
class Interval:
    """Interpolation on begin <= k <= end, plain where zero is not in it.

    Attributes
    ----------
    begin, end : float
    scale : float
        Of `EvenNodes`, where it begins at zero.
    """

    begin: float
    end: float
    scale: float

    @property
    def points(self) -> Array:
        """The nodes."""
        if self.begin == 0:
            return self._even.points
        x = np.cos(np.pi * np.arange(N_OUTSIDE) / (N_OUTSIDE - 1))
        return np.asarray(0.5 * (self.begin + self.end + (self.end - self.begin) * x))

    def at(self, k: Array) -> Array:
        """Matrix from values at the nodes to those at k."""
        if self.begin == 0:
            return self._even.at(k)
        x = (2 * k - self.begin - self.end) / (self.end - self.begin)
        # As even polynomials in cos(θ/2), x = cos θ.
        half = np.sqrt(0.5 * (1 + np.clip(x, -1, 1)))
        return EvenNodes(1.0, LINEAR, N_OUTSIDE).at(half)

    @property
    def _even(self) -> EvenNodes:
        return EvenNodes(self.end, self.scale, N_OUTSIDE)


# So much wider than the interval that arsinh is linear on it.
LINEAR = 1e6


def window_integrals(zone: float, begin: float, end: float) -> tuple[Array, Array]:
    """Nodes k and weights of ∫ f(k) sinc²(k x/2) dk, x = `zone`, begin to end."""
    n_panels = int(np.ceil((end - begin) * zone / (2 * np.pi))) + SPARE
    nodes, weights = np.polynomial.legendre.leggauss(PER_PERIOD)
    width = (end - begin) / n_panels
    k = begin + width * (np.arange(n_panels)[:, None] + 0.5 * (1 + nodes))
    window = np.sinc(k * zone / (2 * np.pi)) ** 2
    return k.ravel(), (0.5 * width * weights * window).ravel()


def zone_variance(
    table: SpectrumTable, zone: float
) -> tuple[float, dict[Axis, float], float]:
    """∫ Ŝ sinc²(k1 x/2) sinc²(k2 x/2) d²k/(2π)², and its errors.

    Parameters
    ----------
    table : SpectrumTable
        Of Ŝ or of a derivative.
    zone : float

    Returns
    -------
    value : float
        Of a web with one unit of length per area the variance of zones of side x.
    by_axis : dict of float
        Its change when the last polynomials of an axis are left out.
    of_nodes : float
        By the errors of the nodes; of Ŝ outside as if all were like the worst.
    """
    inside = _inside(table, zone, None)
    outside = _outside(table, zone, None)
    if table.source.column:
        out_error = _outside(table, zone, None, bound=True)
    else:
        out_error = table.share * abs(outside)
    changes: dict[Axis, float] = {}
    for axis in AXES:
        if axis in ("along", "across"):
            changes[axis] = abs(_inside(table, zone, axis)[0] - inside[0])
        else:
            changes[axis] = abs(_outside(table, zone, axis) - outside)
    return inside[0] + outside, changes, inside[1] + out_error


def _inside(
    table: SpectrumTable, zone: float, fewer: Axis | None
) -> tuple[float, float]:
    """Over the rectangle, a product of two integrals; and what errors of nodes add."""
    rows: list[Array] = []
    sides: tuple[Axis, Axis] = ("along", "across")
    for axis, end in zip(sides, table.ends, strict=True):
        k, weights = window_integrals(zone, 0.0, end)
        rows.append(weights @ table.nodes[axis].at(k, fewer == axis))
    values, errors = table.inside
    value = float(rows[0] @ values @ rows[1])
    error = float(np.abs(rows[0]) @ errors @ np.abs(rows[1]))
    return value / np.pi**2, error / np.pi**2


def _outside(
    table: SpectrumTable, zone: float, fewer: Axis | None, bound: bool = False
) -> float:
    """Over rectangles that double in size, until nothing is left to count.

    Or what errors of the nodes make of it, all of one sign.
    """
    at = table.bound if bound else partial(table, fewer=fewer)
    total = 0.0
    for first, second in _rectangles(table, zone):
        k1, k2 = np.meshgrid(first.points, second.points, indexing="ij")
        rows = []
        for interval in (first, second):
            row = _row(zone, interval)
            rows.append(np.abs(row) if bound else row)
        total += float(rows[0] @ at(k1, k2) @ rows[1])
    return total / np.pi**2


@lru_cache(maxsize=ROWS)
def _row(zone: float, interval: Interval) -> Array:
    """From values at the nodes of an interval to the integral over it."""
    k, weights = window_integrals(zone, interval.begin, interval.end)
    return np.asarray(weights @ interval.at(k))


def _rectangles(
    table: SpectrumTable, zone: float
) -> Iterator[tuple[Interval, Interval]]:
    """Two beside and one at the corner of what was there before."""
    end1, end2 = table.ends
    scales = table.source.ladder.scales
    ridge = table.nodes["direction"].scale
    while min(end1, end2) * zone < FAR_PERIODS or end1 * scales[0] < FAR_SCALES:
        low1, high1 = Interval(0.0, end1, ridge * end1), Interval(end1, 2 * end1, 0.0)
        low2, high2 = Interval(0.0, end2, end2), Interval(end2, 2 * end2, 0.0)
        yield from ((low1, high2), (high1, low2), (high1, high2))
        end1, end2 = 2 * end1, 2 * end2
