"""Steps that are taken in halves where they are too long, and these again."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Generic, TypeVar

from fpsolve.errors import EdgeLengthError, ToleranceError

__all__ = ["Halving"]

State = TypeVar("State")
# A step that is not found so often is none.
MOST_HALVINGS = 12
REMEDY = "enlarge `tolerance` or begin with a smoother motion"


@dataclass(eq=False)
class Halving(Generic[State]):
    """A step, or two halves of it where it is not found or not accurate.

    With a tolerance every step is compared with two of half the length, which are what
    is kept; their distance is the error of the step, and at order 2 four times theirs,
    at order 1 twice. Lengths are halves of halves of the whole step: what is done
    depends on nothing but the state at its beginning.

    Attributes
    ----------
    step : callable
        step(state, t, dt), the state at t + dt; EdgeLengthError where there is none.
    distance : callable
        distance(before, one, other) of two states after `before`; infinite where they
        cannot be compared.
    tolerance : float
        Infinite: steps are repeated only where they are not found.
    rejected : int
        How many steps were taken in halves instead.
    """

    step: Callable[[State, float, float], State]
    distance: Callable[[State, State, State], float]
    tolerance: float
    rejected: int = field(default=0, init=False)

    def __call__(self, state: State, t: float, dt: float) -> State:
        """The state at t + dt.

        Raises
        ------
        EdgeLengthError
            If a step is not found, however short it is.
        ToleranceError
            If the tolerance is not reached by then.
        """
        return self._advanced(state, t, dt, 0, None)

    def _advanced(
        self, state: State, t: float, dt: float, depth: int, whole: State | None
    ) -> State:
        """With the result of a whole step, if that is known already."""
        half, first = 0.5 * dt, None
        try:
            whole = self.step(state, t, dt) if whole is None else whole
            if math.isinf(self.tolerance):
                return whole
            first = self.step(state, t, half)
            second = self.step(first, t + half, half)
            error = self.distance(state, whole, second)
            if error <= self.tolerance:
                return second
            if depth == MOST_HALVINGS:
                raise ToleranceError(error, self.tolerance, REMEDY)
        except EdgeLengthError:
            if depth == MOST_HALVINGS:
                raise
        self.rejected += 1
        middle = self._advanced(state, t, half, depth + 1, first)
        return self._advanced(middle, t + half, half, depth + 1, None)
