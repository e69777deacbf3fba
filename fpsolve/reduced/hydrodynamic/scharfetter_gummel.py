"""∇·(ε∇𝒫 + ε𝒫∇Φ) on cells, with exp(-Φ) exactly stationary."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array

__all__ = ["bernoulli", "generator", "gibbs_masses"]


def bernoulli(x: Array) -> Array:
    """x/(eˣ − 1), 1 at 0, accurate relative to itself for every x.

    b(−x) = eˣ b(x). Written as |x|/(1 − e^{−|x|}) times e^{−max(x, 0)}, which neither
    cancels nor overflows.
    """
    size = np.abs(x)
    small = size < 1e-8
    lost = -np.expm1(-np.where(small, 1.0, size))
    ratio = np.where(small, 1.0 + 0.5 * size, size / lost)
    return np.asarray(ratio * np.exp(-np.maximum(x, 0.0)))


def generator(phi: Array, spacing: tuple[float, float], epsilon: float) -> Any:
    """Q of dm/ds = Q m for the cell masses m of ∂ₛ𝒫 = ε∇·(∇𝒫 + 𝒫∇Φ).

    Between neighbouring cells i and j, h apart, mass flows from i to j at the rate
    (ε/h²) b(Φ_j − Φ_i), b the Bernoulli function, and nothing flows through the walls.
    This is the exact flux where Φ is linear between two centres. Exact: the mass
    (columns sum to zero), exp(−Φ) at the centres is stationary and in detailed
    balance, and off-diagonal entries are positive, whatever h and Φ. Order 2 in h
    where Φ is smooth.

    Parameters
    ----------
    phi : ndarray, shape (n1, n2)
        Φ at the cell centres.
    spacing : (float, float)
        Cell widths (d1, d2).
    epsilon : float

    Returns
    -------
    scipy.sparse.csc_array, shape (n1 n2, n1 n2)
        For masses in C order, `density.ravel() * cell_area`.

    References
    ----------
    [SG69]_ for the flux; [BGKMW08]_ for the equation.
    """
    from scipy.sparse import coo_array, csc_array, dia_array

    numbers = np.arange(phi.size).reshape(phi.shape)
    levels = phi.ravel()
    rows, columns, rates = [], [], []
    for axis, h in enumerate(spacing):
        low, high = _neighbours(numbers, axis)
        rise = levels[high] - levels[low]
        rows += [high, low]
        columns += [low, high]
        rates += [epsilon / h**2 * bernoulli(climb) for climb in (rise, -rise)]
    places = np.concatenate(rows), np.concatenate(columns)
    moves = csc_array(coo_array((np.concatenate(rates), places), (phi.size, phi.size)))
    leaving = np.asarray(moves.sum(axis=0))
    return csc_array(moves - dia_array((leaving[None], [0]), shape=moves.shape))


def gibbs_masses(phi: Array) -> Array:
    """exp(−Φ)/Σ exp(−Φ) in the shape of Φ: the stationary cell masses of Q."""
    weight = np.exp(phi.min() - phi)
    return np.asarray(weight / weight.sum())


def _neighbours(numbers: NDArray[np.int64], axis: int) -> tuple[Any, Any]:
    """Numbers of the cells on the lower and the upper side of every inner face."""
    along = np.moveaxis(numbers, axis, 0)
    return along[:-1].ravel(), along[1:].ravel()
