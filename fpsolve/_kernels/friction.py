"""Coulomb's law between a chain and a belt, in Newton's method for a step or an impact.

A node touches where N − W gap ≥ 0, W its inertia, and N = 0 elsewhere. What moves it
along, R, lies in the disc |R| ≤ μN + b: it sticks where |R − W u| is within it, u the
slip, and slides with R = (μN + b) d, d the direction of R − W u, elsewhere. So every
iteration decides anew, and what it finds satisfies the law exactly [ALC91]_. A node
that begins to slide again and again in one step has −c W u in place of R − W u in it,
friction that holds it c times stiffer than its inertia does.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fpsolve._kernels.banded import solve_banded_rows
from fpsolve._kernels.chain import REACH, step_rows
from fpsolve._kernels.compiling import njit

__all__ = ["AIR", "SLIDES", "STICKS", "Ground", "rub", "strike"]

AIR, STICKS, SLIDES = 0, 1, 2
# Of the disc: what is on its edge to rounding goes on as it did.
ROUNDING = 1e-9
# Of the compliance of an edge: where sliding nodes lie straight between two that stick
# their tensions are not determined, and change as little as possible.
PROXIMAL = 1e-8
# c, and how often a node may begin to slide before it has this law.
STIFF, MOST_TURNS = 3.0, 2


class Ground(NamedTuple):
    """A belt, and what touches it.

    Attributes
    ----------
    friction, height : float
        μ, and where the belt is.
    carried : ndarray, shape (n + 1, 2)
        How far the belt goes under every node in the step, or its velocity.
    may : ndarray of bool, shape (n + 1,)
        Nodes that may touch it.
    state, turns : ndarray of int, shape (n + 1,)
        `AIR`, `STICKS` or `SLIDES`, and how often a node has begun to slide; −1 of one
        that comes down in the step, whose friction is left to the impact.
    reserve : ndarray, shape (n + 1,)
        b.
    reaction : ndarray, shape (n + 1, 3)
        R and N of the last iteration.
    """

    friction: float
    height: float
    carried: NDArray[np.float64]
    may: NDArray[np.bool_]
    state: NDArray[np.int64]
    turns: NDArray[np.int64]
    reserve: NDArray[np.float64]
    reaction: NDArray[np.float64]


@njit(cache=True, error_model="numpy")
def _given(rows, known, row, change):
    """An unknown that changes by that."""
    for j in range(2 * REACH + 1):
        rows[row, j] = 0.0
    rows[row, REACH] = 1.0
    known[row] = change


@njit(cache=True, error_model="numpy")
def _entry(rows, row, column):
    """Of the matrix, 0 beyond the band."""
    j = column - row + REACH
    return rows[row, j] if 0 <= j <= 2 * REACH else 0.0


@njit(cache=True, error_model="numpy")
def _slide_rows(ground, i, inertia, push, rows, known):
    """Rows of R − (μN + b) d = 0; `push` (q_1, q_2, N, whether R is part of q)."""
    size = np.hypot(push[0], push[1])
    limit = ground.friction * push[2] + ground.reserve[i]
    if size == 0.0 or limit == 0.0:
        return
    share, found = limit / size, np.zeros((2, 2 * REACH + 1))
    for c in range(2):
        row, d = 4 * i + c, push[c] / size
        for j in range(2 * REACH + 1):
            column = row - REACH + j
            value = rows[row, j]
            value -= ground.friction * d * _entry(rows, 4 * i + 2, column)
            for k in range(2):
                across = (1.0 if k == c else 0.0) - d * push[k] / size
                own = inertia if column == 4 * i + k else 0.0
                own -= push[3] * _entry(rows, 4 * i + k, column)
                value += share * across * own
            found[c, j] = value
    for c in range(2):
        known[4 * i + c] += limit * push[c] / size
        for j in range(2 * REACH + 1):
            rows[4 * i + c, j] = found[c, j]


@njit(cache=True, error_model="numpy")
def _creep_rows(i, stiff, push, share, rows, known):
    """Rows of R = share q, q = −c W u; `push` (q_1, q_2, …), stiff c W."""
    for c in range(2):
        row = 4 * i + c
        rows[row, REACH] += share * stiff
        known[row] += share * push[c]


@njit(cache=True, error_model="numpy")
def _touch(ground, i, inertia, moved, normal, safe, rows, known):
    """Rows of R of a node that touches the belt; returns whether its state has changed.

    rows, known: of the balance of its forces without the belt; moved: its displacement
    or velocity, `normal` N.
    """
    before = ground.state[i]
    slip_x = moved[0] - ground.carried[i, 0]
    slip_y = moved[1] - ground.carried[i, 1]
    ground.reaction[i, 0], ground.reaction[i, 1] = -known[4 * i], -known[4 * i + 1]
    ground.reaction[i, 2] = normal
    if ground.turns[i] < 0:
        ground.state[i] = SLIDES
        return before != SLIDES
    creeps = ground.turns[i] > (0 if safe else MOST_TURNS)
    part, stiff = (0.0, STIFF * inertia) if creeps else (1.0, inertia)
    push = (
        -part * known[4 * i] - stiff * slip_x,
        -part * known[4 * i + 1] - stiff * slip_y,
        max(normal, 0.0),
        part,
    )
    limit = ground.friction * push[2] + ground.reserve[i]
    limit *= 1.0 - ROUNDING if before == SLIDES else 1.0 + ROUNDING
    inside = np.hypot(push[0], push[1]) < limit
    if creeps and (inside or safe):
        # Outside by the secant, which brings the iteration nearer from anywhere.
        size = np.hypot(push[0], push[1])
        _creep_rows(i, stiff, push, 1.0 if inside or size == 0.0 else limit / size,
                    rows, known)  # fmt: skip
        ground.state[i] = SLIDES
    elif inside:
        ground.state[i] = STICKS
        _given(rows, known, 4 * i, -slip_x)
        _given(rows, known, 4 * i + 1, -slip_y)
    else:
        ground.turns[i] += before == STICKS
        ground.state[i] = SLIDES
        _slide_rows(ground, i, stiff, push, rows, known)
    return ground.state[i] != before


@njit(cache=True, error_model="numpy")
def _edges_between(chain, ground, compliance, rows, known):
    """Tension stays between two nodes that stick, and changes little beside one.

    Whether what sticks is pulled or pushed is not determined by where it is: what it
    was when it came to rest is locked in, until more pulls at it than friction holds.
    """
    for i in range(chain.masses.size - 1):
        row, still, held = 4 * i + 7, 0, 0
        for j in range(i, i + 2):
            still += ground.state[j] == STICKS or chain.fixed[j, 0]
            held += chain.fixed[j, 0]
        if still == 2 and held < 2:
            _given(rows, known, row, 0.0)
        elif ground.state[i] != AIR or ground.state[i + 1] != AIR:
            rows[row, REACH] -= PROXIMAL * compliance


@njit(cache=True, error_model="numpy")
def _improve(chain, moved, tension, rows, known):
    """Solve, and add what is found; returns the largest change of `moved`."""
    solve_banded_rows(rows, known)
    largest, n = 0.0, chain.masses.size - 1
    for i in range(n + 1):
        for c in range(3):
            change = 0.0 if chain.fixed[i, c] else known[4 * i + c]
            moved[i, c] += change
            if not abs(change) <= largest and not np.isnan(largest):
                largest = abs(change)
        if i > 0:
            tension[i - 1] += known[4 * i + 3]
    return largest


@njit(cache=True, error_model="numpy")
def rub(chain, step, iterate, pull, ground, safe, rows, known):
    """`newton` with a belt; returns the largest displacement added and the switches.

    With `safe` what creeps does so by a secant of its law, which converges slowly from
    anywhere. A node that comes down has as normal force what stops it by implicit
    Euler, whatever θ, so that the rest of its momentum is left to the impact.
    """
    n, switched = chain.masses.size - 1, 0
    step_rows(chain, step, iterate, pull, rows, known)
    for i in range(n + 1):
        if not ground.may[i]:
            continue
        slow = chain.masses[i] / (step.theta * step.dt)
        late = slow * (iterate.moved[i, 2] / step.dt - iterate.v[i, 2])
        gap = iterate.r[i, 2] + iterate.moved[i, 2] - ground.height
        normal = -known[4 * i + 2] - (1 - step.theta) * late
        if not normal - slow / step.dt * gap >= 0.0:
            switched += ground.state[i] != AIR
            ground.state[i] = AIR
            ground.reaction[i] = 0.0
            continue
        switched += _touch(
            ground,
            i,
            slow / step.dt,
            iterate.moved[i],
            normal,
            safe,
            rows,
            known,
        )
        _given(rows, known, 4 * i + 2, -gap)
    light = step.theta * step.dt**2 / chain.masses[n // 2]
    _edges_between(chain, ground, light, rows, known)
    return _improve(chain, iterate.moved, iterate.tension, rows, known), switched


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def _impact_rows(chain, iterate, rows, known):
    """M (w − v) = G^T λ, G w = 0, in (w, λ) in place of (Δr, T)."""
    n = chain.masses.size - 1
    r, v, w, impulse = iterate
    rows[:], known[:] = 0.0, 0.0
    # The node that comes first has no edge before it.
    rows[3, REACH] = 1.0
    for i in range(n + 1):
        for c in range(3):
            row = 4 * i + c
            if chain.fixed[i, c]:
                rows[row, REACH] = 1.0
                continue
            rows[row, REACH] = chain.masses[i]
            known[row] = chain.masses[i] * (v[i, c] - w[i, c])
            if i < n:
                along = (r[i + 1, c] - r[i, c]) / chain.edge
                known[row] += impulse[i] * along
                rows[row, REACH + 7 - c] = -along
            if i > 0:
                along = (r[i, c] - r[i - 1, c]) / chain.edge
                known[row] -= impulse[i - 1] * along
                rows[row, REACH + 3 - c] = along
        if i > 0:
            _impact_edge(chain, iterate, i, rows, known)


@njit(cache=True, error_model="numpy")
def _impact_edge(chain, iterate, i, rows, known):
    """G w = 0 of the edge before node i; nothing is left to one between two held."""
    r, w, row, held = iterate.r, iterate.moved, 4 * i + 3, True
    for c in range(3):
        along = (r[i, c] - r[i - 1, c]) / chain.edge
        rows[row, REACH - 7 + c] = -along
        rows[row, REACH - 3 + c] = along
        known[row] -= along * (w[i, c] - w[i - 1, c])
        held &= chain.fixed[i - 1, c] and chain.fixed[i, c]
    if held:
        _given(rows, known, row, 0.0)


@njit(cache=True, error_model="numpy")
def strike(chain, iterate, ground, safe, rows, known):
    """Improve the velocities w after a plastic impact, `moved`, and the impulses.

    Every node that may touch the belt does. Otherwise as `rub`.
    """
    switched = 0
    _impact_rows(chain, iterate, rows, known)
    for i in range(chain.masses.size):
        if ground.may[i]:
            switched += _touch(
                ground, i, chain.masses[i], iterate.moved[i], -known[4 * i + 2],
                safe, rows, known,
            )  # fmt: skip
            _given(rows, known, 4 * i + 2, -iterate.moved[i, 2])
    light = 1.0 / chain.masses[chain.masses.size // 2]
    _edges_between(chain, ground, light, rows, known)
    return _improve(chain, iterate.moved, iterate.tension, rows, known), switched
