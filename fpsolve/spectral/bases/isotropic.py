"""What an isotropic potential on a fixed belt allows: sums of g_k(r) exp(ilφ + ikα)."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from fpsolve._support.arrays import Complex
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.spectral.bases.sectors import Integers, Sector, Vector

__all__ = ["harmonics_of", "index_of", "isotropic_sectors", "on_grid"]


def isotropic_sectors() -> Iterator[Sector]:
    """M = 0 even, M = 0 odd, ±1, ±2, ..."""
    yield Sector(0, 1)
    yield Sector(0, -1)
    yield from (Sector(M) for M in itertools.count(1))


def index_of(sector: Sector) -> int:
    """M; ValueError for a sector of another symmetry."""
    if sector.M is None:
        raise ValueError(f"`sector` must have an angular index M, got {sector!r}.")
    return sector.M


def harmonics_of(sector: Sector, harmonics: int) -> Integers:
    """The harmonics k of a sector in ascending order.

    For M = 0 only k >= 0 (even) or k >= 1 (odd) are kept: the others follow by the
    reflection.
    """
    first = {None: -harmonics, 1: 0, -1: 1}[sector.parity]
    return np.arange(first, harmonics + 1)


def on_grid(
    modes: Vector, sector: Sector, k: Integers, grid: PhaseSpaceGrid
) -> Complex:
    """Σ g_k(r) exp(ilφ + ikα) with l + k = M on a grid; shape ``grid.shape``.

    Parameters
    ----------
    modes : ndarray, shape (n_harmonics, n1 n2)
        g_k at the distances of the cells from the origin.
    sector : Sector
        Of a parity: √2 Re (even) or √2 Im (odd) of every term.
    k : ndarray of int, shape (n_harmonics,)
    grid : PhaseSpaceGrid
    """
    xi1, xi2 = (axis.ravel() for axis in np.broadcast_arrays(*grid.plane()))
    angular = index_of(sector) - k
    plane = np.exp(1j * angular[:, None] * np.arctan2(xi2, xi1))
    circle = np.exp(1j * k[:, None] * grid.alpha)
    if sector.parity is None:
        result = (modes * plane).T @ circle
    else:
        # The harmonic 0 is real already, and counts once.
        modes = modes * np.where(k == 0, 0.5, np.sqrt(0.5))[:, None]
        state = (modes * plane).T @ circle
        mirrored = (modes * plane.conj()).T @ circle.conj()
        even = sector.parity == 1
        result = state + mirrored if even else (state - mirrored) / 1j
    return np.asarray(result, dtype=np.complex128).reshape(grid.shape)
