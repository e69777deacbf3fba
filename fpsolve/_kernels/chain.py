"""Newton's method for one step of a chain of edges that keep their length.

Unknowns (r_i, T_{i − 1}) of a node and the edge before it side by side, of which
bending reaches two nodes far: a matrix of eight diagonals to either side. What holds a
node, or one coordinate of it, is a row of the identity.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fpsolve._kernels.banded import REACH, solve_banded_rows
from fpsolve._kernels.compiling import njit

__all__ = [
    "REACH",
    "Chain",
    "Iterate",
    "Pull",
    "Step",
    "largest_stretch",
    "newton",
    "step_rows",
]


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


@njit(cache=True, error_model="numpy", forceinline=True)
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


@njit(cache=True, error_model="numpy", forceinline=True)
def _node_rows(chain, step, iterate, pull, i, middle, rows, known):
    """Rows of the balance of forces at node i; `middle` is r^θ from node −2 on.

    Every number is written once: what is read again between writes to other arrays
    takes five times as long.
    """
    n = chain.masses.size - 1
    theta, per_time, per_edge = step.theta, 1.0 / step.dt, 1.0 / chain.edge
    slow = chain.masses[i] * per_time / theta
    inertia = (slow + step.damping * chain.masses[i]) * per_time
    after = iterate.tension[i] * per_edge if i < n else 0.0
    before = iterate.tension[i - 1] * per_edge if i > 0 else 0.0
    k0, k1, k2, k3, k4 = chain.bending[i]
    diagonal = inertia + theta * (k2 + before + after)
    for c in range(3):
        row = rows[4 * i + c]
        if chain.fixed[i, c]:
            row[REACH], known[4 * i + c] = 1.0, 0.0
            continue
        here = middle[i + 2, c]
        along, behind = middle[i + 3, c] - here, here - middle[i + 1, c]
        force = chain.constant[i, c] + pull.force[i, c]
        force += after * along - before * behind - k2 * here
        force -= k1 * middle[i + 1, c] + k3 * middle[i + 3, c]
        force -= k0 * middle[i, c] + k4 * middle[i + 4, c]
        row[0], row[REACH - 4] = theta * k0, theta * (k1 - before)
        row[REACH + 4], row[2 * REACH] = theta * (k3 - after), theta * k4
        row[REACH + 3 - c], row[REACH + 7 - c] = behind * per_edge, -along * per_edge
        for d in range(3):
            row[REACH + d - c] = pull.slope[i, c, d] * per_time
        row[REACH] += diagonal
        force += slow * iterate.v[i, c] - inertia * iterate.moved[i, c]
        known[4 * i + c] = force


@njit(cache=True, error_model="numpy", forceinline=True)
def _edge_row(chain, iterate, i, row):
    """Row of the length of edge i at the end of the step; returns its right side."""
    r, _, moved, tension = iterate
    free = False
    for c in range(3):
        free |= not (chain.fixed[i, c] and chain.fixed[i + 1, c])
    if not free:
        # Nothing is left to its tension, which is none.
        row[REACH] = 1.0
        return -tension[i]
    square = 0.0
    for c in range(3):
        end = (r[i + 1, c] + moved[i + 1, c]) - (r[i, c] + moved[i, c])
        square += end * end
        row[REACH - 7 + c] = -end / chain.edge
        row[REACH - 3 + c] = end / chain.edge
    return (chain.edge * chain.edge - square) / (2 * chain.edge)


@njit(cache=True, error_model="numpy")
def step_rows(chain, step, iterate, pull, rows, known):
    """The linear system of an iteration, rows (4n + 4, 17), known (4n + 4,)."""
    n = chain.masses.size - 1
    middle = np.zeros((n + 5, 3))
    for i in range(n + 1):
        for c in range(3):
            middle[i + 2, c] = iterate.r[i, c] + step.theta * iterate.moved[i, c]
    rows[:] = 0.0
    # The node that comes first has no edge before it.
    rows[3, REACH], known[3] = 1.0, 0.0
    for i in range(n + 1):
        _node_rows(chain, step, iterate, pull, i, middle, rows, known)
        if i > 0:
            known[4 * i + 3] = _edge_row(chain, iterate, i - 1, rows[4 * i + 3])


@njit(cache=True, error_model="numpy")
def newton(chain, step, iterate, pull, rows, known):
    """Improve `moved` and `tension` in place; returns how far, and what is left.

    That is the largest displacement added and the largest stretch, NaN if one is. rows
    (4n + 4, 17), known (4n + 4,): room, whatever it holds. By Gauss without pivots: as
    long as inertia, bending and tension resist every displacement, every row has a
    pivot, the last of an edge because it comes after both of its ends.
    """
    n = chain.masses.size - 1
    step_rows(chain, step, iterate, pull, rows, known)
    solve_banded_rows(rows, known)
    largest = 0.0
    for i in range(n + 1):
        for c in range(3):
            # Elimination leaves rounding where nothing moves.
            change = 0.0 if chain.fixed[i, c] else known[4 * i + c]
            iterate.moved[i, c] += change
            # NaN is the largest of all.
            if not abs(change) <= largest and not np.isnan(largest):
                largest = abs(change)
        if i > 0:
            iterate.tension[i - 1] += known[4 * i + 3]
    return largest, largest_stretch(chain.edge, iterate.r, iterate.moved)
