"""Over which length the density of a web remembers itself."""

from __future__ import annotations

import numpy as np

from fpsolve._support.arrays import Array

__all__ = ["correlation_lengths"]

# Fewer cells along an axis say nothing about a correlation along it.
_FEWEST_CELLS = 4
# Of the largest mean; less is what rounding leaves of equal cells.
_ROUNDING = 1e-13
# Standard errors of an autocorrelation of nothing, below which it counts as noise.
_NOISE = 2.0


def correlation_lengths(means: Array, cell: float) -> tuple[float, float]:
    """ℓ = x (1 + 2 Σ_h ρ(h x)²) in cross and machine direction, x the side of a cell.

    Second moments of a stationary Gaussian field over an interval D have the relative
    variance of D/ℓ independent values. The sum ends where ρ is lost in its noise.
    Rows and columns lose their mean first: a strip is a pattern and no memory.

    Parameters
    ----------
    means : array
        Means of the cells, cross × machine direction.
    cell : float
        Side of a cell.
    """
    centred = means - means.mean()
    random = centred - centred.mean(axis=0) - centred.mean(axis=1)[:, None]
    random[np.abs(random) <= _ROUNDING * np.abs(means).max()] = 0.0
    return _length(random, cell), _length(random.T, cell)


def _length(random: Array, cell: float) -> float:
    """Return ℓ along the first axis; one cell where it is short, or all are equal."""
    n = random.shape[0]
    variance = float(np.mean(random**2))
    if n < _FEWEST_CELLS or not variance > 0:
        return cell
    rho = _autocovariance(random)[1 : n // 2 + 1] / variance
    lost = rho < _NOISE / np.sqrt(random.size)
    last = int(np.argmax(lost)) if lost.any() else len(rho)
    return cell * float(1.0 + 2.0 * np.sum(rho[:last] ** 2))


def _autocovariance(random: Array) -> Array:
    """Return the mean product at every lag along the first axis."""
    n = random.shape[0]
    waves = np.fft.rfft(random, 2 * n, axis=0)
    products = np.fft.irfft(np.sum(np.abs(waves) ** 2, axis=1), 2 * n)[:n]
    return np.asarray(products / (random.shape[1] * np.arange(n, 0, -1)))
