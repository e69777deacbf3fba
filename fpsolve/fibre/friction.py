"""Steps and impacts of a chain that rubs on a belt."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fpsolve._kernels.chain import REACH, Chain, Iterate, Step, largest_stretch
from fpsolve._kernels.friction import AIR, STICKS, Ground, rub, strike
from fpsolve._support.arrays import Array
from fpsolve.errors import FrictionError
from fpsolve.fibre.ends import Belt
from fpsolve.fibre.newton import KEPT, MOST_ITERATIONS, Wind, no_pull

__all__ = ["ground_under", "rubbed_step", "struck"]

# Of the largest velocity: changes that an impact may leave.
SETTLED = 1e-9
# Iterations of Newton's method before those of the secant, and how many these are: at
# kinks of the law the first may go to and fro.
WHOLE, SAFE = 9, 25


def ground_under(
    belt: Belt, fixed: NDArray[np.bool_], state: NDArray[np.int64], carried: Array
) -> Ground:
    """The belt under all nodes that are not held."""
    size, turns = state.size, np.where(state == AIR, -1, 0)
    return Ground(
        belt.friction, belt.height, carried, ~fixed[:, 2], state.copy(), turns,
        np.zeros(size), np.zeros((size, 3)),
    )  # fmt: skip


def rubbed_step(
    chain: Chain,
    step: Step,
    iterate: Iterate,
    wind: Wind | None,
    t: float,
    force: Array | None,
    ground: Ground,
) -> int:
    """As `found_step`, with the law of friction at the nodes that touch the belt.

    Which stick, slide and touch is decided in every iteration, and must stay what it
    is in the last two.

    Raises
    ------
    FrictionError
        If Newton's method does not converge.
    """
    rows, known = _room(chain)
    pull, allowed = no_pull(chain.masses), KEPT * chain.edge
    change, left, switched = np.inf, np.inf, chain.masses.size
    # A front of sliding may go on by one node in an iteration.
    for iteration in range(MOST_ITERATIONS + SAFE + chain.masses.size):
        left = largest_stretch(chain.edge, iterate.r, iterate.moved)
        if change <= 1e3 * allowed and left <= allowed and not switched:
            return iteration
        if not np.isfinite(left):
            break
        if wind is not None and not wind.meets(
            chain, step, iterate, t, pull, iteration + 1
        ):
            break
        if force is not None:
            pull.force[...] = force if wind is None else pull.force + force
        change, switched = rub(
            chain, step, iterate, pull, ground, _safe(iteration), rows, known
        )
    raise FrictionError(t, step.dt, float(left / chain.edge), int(switched))


def struck(chain: Chain, step: Step, iterate: Iterate, t: float, ground: Ground) -> int:
    """Velocities `moved` after a plastic impact on the belt, found in place.

    What friction of the step has left over, (μN − |R|)Δ, holds what sticks and what
    comes down as well.

    Raises
    ------
    FrictionError
        If they are not found.
    """
    rows, known = _room(chain)
    rubbing = np.hypot(ground.reaction[:, 0], ground.reaction[:, 1])
    pressing = np.maximum(ground.reaction[:, 2], 0.0)
    unused = ground.may & ((ground.state == STICKS) | (ground.turns < 0))
    left_over = np.maximum(ground.friction * pressing - rubbing, 0.0) * step.dt
    ground.reserve[:] = np.where(unused, left_over, 0.0)
    ground.turns[:] = 0
    size, switched = float(np.abs(iterate.v).max()), 0
    for iteration in range(1, MOST_ITERATIONS + SAFE + chain.masses.size):
        change, switched = strike(chain, iterate, ground, _safe(iteration), rows, known)
        if change <= SETTLED * size and not switched:
            return iteration
        if not np.isfinite(change):
            break
    raise FrictionError(t, step.dt, 0.0, int(switched))


def _safe(iteration: int) -> bool:
    """Whether that is one of the secant."""
    return WHOLE < iteration <= WHOLE + SAFE


def _room(chain: Chain) -> tuple[Array, Array]:
    """For a matrix and what is known."""
    size = 4 * chain.masses.size
    return np.empty((size, 2 * REACH + 1)), np.empty(size)
