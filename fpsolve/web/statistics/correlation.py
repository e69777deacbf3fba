"""Over which length the density of a web remembers itself."""

from __future__ import annotations

import numpy as np

from fpsolve._support.arrays import Array, Complex

__all__ = ["memories", "memory"]

# Fewer cells along an axis say nothing about a correlation along it.
_FEWEST_CELLS = 4
# Bins of a series, at most.
_BINS = 32
# Of the largest; less is what rounding leaves of equal cells.
_ROUNDING = 1e-13


def memories(field: Array, cell: float) -> tuple[float, float]:
    """ℓ - x in cross and machine direction, of the means of a field over the other one.

    Means over a whole width are what a mean over the web is made of. Of single cells
    the noise hides how long they remember, and a strip, which is a pattern, looks like
    a memory along itself.

    Parameters
    ----------
    field : array
        Cross × machine direction.
    cell : float
        Side of a cell.
    """
    cross, machine = (field.mean(axis=axis)[:, None] for axis in (1, 0))
    return memory(cross, cell), memory(machine, cell)


def memory(series: Array | Complex, cell: float) -> float:
    """ℓ - x = 2 x Σ_h ρ(h x) of a series in 32 bins of side x: D has D/ℓ values.

    The sum ends where ρ is negative for the first time; what follows is noise, or the
    other half of a wave. In finer bins the noise of every cell would hide a memory that
    is weak and long, and end the sum early.

    Parameters
    ----------
    series : array
        Along the first axis; products are averaged over the second one.
    cell : float
        Side of a cell.
    """
    n = min(len(series), _BINS)
    starts = np.arange(n) * len(series) // n
    sizes = np.diff(np.append(starts, len(series)))[:, None]
    cell *= len(series) / n
    series = np.add.reduceat(series, starts, axis=0) / sizes
    centred = series - series.mean(axis=0)
    variance = float(np.mean(np.abs(centred) ** 2))
    if n < _FEWEST_CELLS or not variance > (_ROUNDING * np.abs(series).max()) ** 2:
        return 0.0
    waves = np.fft.fft(centred, 2 * n, axis=0)
    products = np.fft.ifft(np.sum(np.abs(waves) ** 2, axis=1)).real[:n]
    rho = products[1:] / products[0]
    negative = rho < 0
    last = int(np.argmax(negative)) if negative.any() else n - 1
    return 2.0 * cell * float(np.sum(rho[:last]))
