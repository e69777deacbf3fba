"""Newton's method for the step of a chain, in whatever flow it is."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fpsolve._kernels.chain import (
    REACH,
    Chain,
    Iterate,
    Pull,
    Step,
    newton,
)
from fpsolve._kernels.drag import Drag, pull_chain
from fpsolve._support.arrays import Array
from fpsolve.errors import EdgeLengthError, FlowRangeError
from fpsolve.fibre.air import AirFlow
from fpsolve.fibre.string import String

__all__ = ["Wind", "found_step", "no_pull"]

# Of an edge: deviations of its length that Newton's method leaves.
KEPT = 1e-12
# Times that: changes of places that it would make next.
FOLLOWS = 100.0
MOST_ITERATIONS = 25


@dataclass(frozen=True, eq=False)
class Wind:
    """The air around a fibre, as a force on the nodes of its chain.

    Attributes
    ----------
    air : AirFlow
    string : String
        Of which diameter and weight count.
    """

    air: AirFlow
    string: String

    @cached_property
    def _drag(self) -> Drag:
        return self.air.drag(self.string.diameter)

    def pull(
        self, chain: Chain, step: Step, iterate: Iterate, t: float, pull: Pull
    ) -> None:
        """Its force in the middle of the step and the slope of it, into `pull`.

        How the force changes with the place and the direction of the fibre is
        neglected in the slope, which costs an iteration.
        """
        middle = iterate.r + step.theta * iterate.moved
        wind = self.air.at(middle, t + step.theta * step.dt)
        lengths = chain.masses / self.string.line_density
        rate = iterate.moved / step.dt
        pull_chain(self._drag, middle, rate, wind, lengths, *pull)

    def meets(
        self,
        chain: Chain,
        step: Step,
        iterate: Iterate,
        t: float,
        pull: Pull,
        turn: int,
    ) -> bool:
        """As `pull`; False where an iteration has led out of the flow.

        A fibre that begins the first there has left the flow itself.

        Raises
        ------
        FlowRangeError
            In the first iteration.
        """
        try:
            self.pull(chain, step, iterate, t, pull)
        except FlowRangeError:
            if turn == 1:
                raise
            return False
        return True


def found_step(
    chain: Chain,
    step: Step,
    iterate: Iterate,
    wind: Wind | None,
    t: float,
    force: Array | None = None,
) -> int:
    """Solve for `moved` and `tension` of the iterate in place; returns iterations.

    A `force` on the nodes, shape (n + 1, 3), acts throughout.

    Raises
    ------
    EdgeLengthError
        If Newton's method does not converge.
    """
    size = 4 * chain.masses.size
    rows, known = np.empty((size, 2 * REACH + 1)), np.empty(size)
    pull = no_pull(chain.masses)
    allowed, change = KEPT * chain.edge, 0.0
    for iteration in range(1, MOST_ITERATIONS + 1):
        if wind is not None and not wind.meets(
            chain, step, iterate, t, pull, iteration
        ):
            break
        if force is not None:
            pull.force[...] = force if wind is None else pull.force + force
        before = change
        change, left = newton(chain, step, iterate, pull, rows, known)
        if not np.isfinite(left):
            break
        # Of the next, if this is to the last as that will be to this, which is far
        # too much where Newton's method is quadratic.
        ahead = change * min(change / before, 1.0) if before else change
        if left <= allowed and ahead <= FOLLOWS * allowed:
            return iteration
    raise EdgeLengthError(t, step.dt, float(left / chain.edge))


def no_pull(masses: Array) -> Pull:
    """No force on any node."""
    return Pull(np.zeros((masses.size, 3)), np.zeros((masses.size, 3, 3)))
