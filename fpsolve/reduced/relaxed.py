"""A solution by implicit steps of dm/ds = Q m."""

from __future__ import annotations

import math

from fpsolve._support.arrays import Array
from fpsolve.evolution.decay import DecayRate, fit_decay
from fpsolve.evolution.evolution import Evolution

__all__ = ["Relaxed"]


class Relaxed(Evolution):
    """An evolution of cell masses by a method of `fpsolve.reduced.implicit`.

    Attributes
    ----------
    method : str
    """

    method: str

    def entropy_rate(self, window: tuple[float, float] | None = None) -> DecayRate:
        """Rate λ of H ~ e^{−λs}, fitted on a window of s; tends to twice the gap.

        Twice that of the grid: its error contains that of the step, from `errors` if
        there are any, and nothing of the cells. An implicit step of length h takes a
        mode e^{−μs} by 1/(1 + μh), so that the fitted λ = 2 ln(1 + μh)/h is short by
        the share (e^{λh/2} − 1)/(λh/2) − 1 (backward_euler), or by (λh)²/40 (sdirk2).
        """
        return super().entropy_rate(window)

    def _of_step(self, above: Array, window: tuple[float, float] | None) -> float:
        turn = fit_decay(self.series["s"], above, window).rate * self.ds
        if self.method == "backward_euler":
            return math.expm1(turn / 2) / (turn / 2) - 1
        return turn**2 / 40
