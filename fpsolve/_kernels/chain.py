"""Newton's method for one step of a chain of edges that keep their length.

Unknowns (r_i, T_i) of node and edge side by side, of which bending reaches two nodes
far: a matrix of eight diagonals to either side. What holds a node, or one coordinate
of it, is a row of the identity.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fpsolve._kernels.banded import solve_banded_rows
from fpsolve._kernels.compiling import njit

__all__ = ["Chain", "Iterate", "Pull", "Step", "largest_stretch", "newton"]

# Bandwidth of unknowns (r_i, T_i) side by side: bending reaches two nodes far.
REACH = 8


class Chain(NamedTuple):
    """M ∂_tt r = −K r + f + ∂φ^T T of n edges.

    Attributes
    ----------
    bending : ndarray, shape (n + 1, 5)
        K_{i, i − 2} to K_{i, i + 2}.
    constant : ndarray, shape (n + 1, 3)
        f.
    masses : ndarray, shape (n + 1,)
    fixed : ndarray of bool, shape (n + 1, 3)
        Coordinates whose displacement is given.
    edge : float
        h.
    """

    bending: NDArray[np.float64]
    constant: NDArray[np.float64]
    masses: NDArray[np.float64]
    fixed: NDArray[np.bool_]
    edge: float


class Step(NamedTuple):
    """Δ, θ, and the damping per mass."""

    dt: float
    theta: float
    damping: float


class Iterate(NamedTuple):
    """r and v at the beginning, the displacement until the end, and T."""

    r: NDArray[np.float64]
    v: NDArray[np.float64]
    moved: NDArray[np.float64]
    tension: NDArray[np.float64]


class Pull(NamedTuple):
    """Other forces on the nodes, and −∂/∂v of them."""

    force: NDArray[np.float64]
    slope: NDArray[np.float64]


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def _stretched(edge, r, moved, i):
    """φ_i = (|e_i|² − h²)/(2h) at the end of the step."""
    square = 0.0
    for c in range(3):
        along = (r[i + 1, c] + moved[i + 1, c]) - (r[i, c] + moved[i, c])
        square += along * along
    return (square - edge * edge) / (2 * edge)


@njit(cache=True, error_model="numpy")
def largest_stretch(edge, r, moved):
    """max |φ_i|; NaN if one is."""
    worst = 0.0
    for i in range(r.shape[0] - 1):
        one = abs(_stretched(edge, r, moved, i))
        if not one <= worst:
            worst = one
            if np.isnan(one):
                break
    return worst


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def _node_rows(chain, step, iterate, pull, i, rows, known):
    """Rows of the balance of forces at node i."""
    n = chain.masses.size - 1
    r, v, moved, tension = iterate
    theta, h = step.theta, chain.edge
    slow = chain.masses[i] / (theta * step.dt)
    inertia = slow / step.dt + step.damping * chain.masses[i] / step.dt
    after = tension[i] / h if i < n else 0.0
    before = tension[i - 1] / h if i > 0 else 0.0
    for c in range(3):
        row = 4 * i + c
        first = max(0, row - REACH)
        if chain.fixed[i, c]:
            rows[row, row - first] = 1.0
            continue
        force = chain.constant[i, c] + pull.force[i, c]
        for apart in range(max(-2, -i), min(2, n - i) + 1):
            j = i + apart
            stiffness = chain.bending[i, apart + 2]
            force -= stiffness * (r[j, c] + theta * moved[j, c])
            rows[row, 4 * j + c - first] = theta * stiffness
        here = r[i, c] + theta * moved[i, c]
        if i < n:
            along = r[i + 1, c] + theta * moved[i + 1, c] - here
            force += after * along
            rows[row, row + 4 - first] -= theta * after
            rows[row, 4 * i + 3 - first] = -along / h
        if i > 0:
            along = here - (r[i - 1, c] + theta * moved[i - 1, c])
            force -= before * along
            rows[row, row - 4 - first] -= theta * before
            rows[row, 4 * i - 1 - first] = along / h
        rows[row, row - first] += inertia + theta * (before + after)
        for d in range(3):
            rows[row, 4 * i + d - first] += pull.slope[i, c, d] / step.dt
        known[row] = force - inertia * moved[i, c] + slow * v[i, c]


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def _edge_row(chain, iterate, i, rows, known):
    """Row of the length of edge i at the end of the step."""
    r, _, moved, tension = iterate
    row = 4 * i + 3
    first = max(0, row - REACH)
    free = False
    for c in range(3):
        free |= not (chain.fixed[i, c] and chain.fixed[i + 1, c])
    if not free:
        # Nothing is left to its tension, which is none.
        rows[row, row - first] = 1.0
        known[row] = -tension[i]
        return
    for c in range(3):
        end = (r[i + 1, c] + moved[i + 1, c]) - (r[i, c] + moved[i, c])
        rows[row, 4 * i + c - first] = -end / chain.edge
        rows[row, 4 * (i + 1) + c - first] = end / chain.edge
    known[row] = -_stretched(chain.edge, r, moved, i)


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def newton(chain, step, iterate, pull, rows, known):
    """Improve `moved` and `tension` in place; returns the largest displacement added.

    rows (4n + 3, 17), known (4n + 3,): room, whatever it holds.
    """
    n = chain.masses.size - 1
    for row in range(4 * n + 3):
        known[row] = 0.0
        for j in range(2 * REACH + 1):
            rows[row, j] = 0.0
    for i in range(n + 1):
        _node_rows(chain, step, iterate, pull, i, rows, known)
        if i < n:
            _edge_row(chain, iterate, i, rows, known)
    solve_banded_rows(rows, known)
    largest = 0.0
    for i in range(n + 1):
        for c in range(3):
            # Pivots leave rounding where nothing moves.
            change = 0.0 if chain.fixed[i, c] else known[4 * i + c]
            iterate.moved[i, c] += change
            # NaN is the largest of all.
            if not abs(change) <= largest and not np.isnan(largest):
                largest = abs(change)
        if i < n:
            iterate.tension[i] += known[4 * i + 3]
    return largest
