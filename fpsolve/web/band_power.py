"""The share of the variance that waves of some length have."""

from __future__ import annotations

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.web.table import AXES, SpectrumTable

__all__ = ["band_power"]

# Nodes of Gauss per octave of |k| and over a quarter of the directions.
PER_OCTAVE, N_DIRECTIONS = 24, 64


def band_power(
    table: SpectrumTable, longest: float, shortest: float
) -> tuple[float, float]:
    """∫ Ŝ d²k/(2π)² over wavelengths 2π/|k| from `shortest` to `longest`; its error.

    Of a table of derivatives it is the derivative of that.
    """
    k1, k2, weights = _nodes(table, 2 * np.pi / longest, 2 * np.pi / shortest)
    power = float(weights @ table(k1, k2))
    changes = [abs(float(weights @ table(k1, k2, axis)) - power) for axis in AXES]
    if table.source.column:
        of_nodes = float(weights @ table.bound(k1, k2))
    else:
        of_nodes = max(table.share, table.source.tolerance) * power
    return power / np.pi**2, (sum(changes) + of_nodes) / np.pi**2


def _nodes(table: SpectrumTable, low: float, high: float) -> tuple[Array, Array, Array]:
    """Wave vectors of a quarter of a ring, and their weights."""
    nodes, weights = np.polynomial.legendre.leggauss(PER_OCTAVE)
    n_octaves = int(np.ceil(np.log2(high / low)))
    edges = np.geomspace(low, high, n_octaves + 1)
    half = 0.5 * np.diff(edges)[:, None]
    size = (edges[:-1, None] + half * (1 + nodes)).ravel()
    by_size = (half * weights).ravel() * size
    # Denser towards the direction across the belt, where slow modes make a ridge.
    scale = table.nodes["direction"].scale
    x, by_x = np.polynomial.legendre.leggauss(N_DIRECTIONS)
    stretch = np.arcsinh(0.5 * np.pi / scale)
    off = scale * np.sinh(0.5 * (1 + x) * stretch)
    by_off = 0.5 * by_x * stretch * np.hypot(off, scale)
    k1 = np.multiply.outer(size, np.sin(off)).ravel()
    k2 = np.multiply.outer(size, np.cos(off)).ravel()
    return k1, k2, np.multiply.outer(by_size, by_off).ravel()
