"""The generator as blocks between angular indices, folded by reflection."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from scipy.sparse import csc_array, eye_array, kron

from fpsolve.spectral.bases.coupled_states import CoupledStates
from fpsolve.spectral.bases.curvature import CurvatureOperators

__all__ = ["Blocks", "coupled", "rows"]


@dataclass(frozen=True)
class Blocks:
    """The generator between angular indices, on plain states.

    Attributes
    ----------
    own : csc_array
        From M to M, but for what grows with M.
    turning : csc_array
        iκ, M times of which belong to `own`.
    couplings : dict of csc_array
        From M to M + 1, M - 1, M + 2 and M - 2; what vanishes is left out.
    """

    own: csc_array
    turning: csc_array
    couplings: dict[int, csc_array]


def coupled(
    moving: dict[int, Any], forcing: dict[int, Any], kappa: CurvatureOperators
) -> dict[int, csc_array]:
    """The couplings that are not zero."""
    same = eye_array(kappa.forced.shape[0])
    found = {}
    for step, motion in moving.items():
        block = csc_array(kron(motion, same) + kron(forcing[step], kappa.forced))
        block.eliminate_zeros()
        if block.nnz:
            found[step] = block
    return found


def rows(states: CoupledStates, blocks: Blocks) -> list[list[csc_array | None]]:
    """The blocks of the matrix [to][from], folded by reflection."""
    table: list[list[csc_array | None]] = []
    for into in map(int, states.M):
        table.append([block(states, blocks, into, int(start)) for start in states.M])
    return table


def block(
    states: CoupledStates, blocks: Blocks, into: int, start: int
) -> csc_array | None:
    """From `start` to `into`, both not negative, and what the reflection adds."""
    steps = blocks.couplings
    if into == start:
        own = blocks.own + start * blocks.turning
        if into == 0:
            return csc_array(states.folding.T @ own @ states.folding)
        # M = 1 meets -1, which is 1 by reflection.
        if into == 1 and -2 in steps:
            own = own + states.mirror @ steps[-2]
        return csc_array(own)
    step = steps.get(into - start)
    if step is None:
        return None
    if start == 0:
        return csc_array(math.sqrt(2.0) * (step @ states.folding))
    if into == 0:
        return csc_array(math.sqrt(2.0) * (states.folding.T @ step))
    return step
