"""How fibres are laid step by step, each nozzle in its own phase."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fpsolve._kernels.paths import N_STATE
from fpsolve._kernels.threads import threads_worth_their_wait
from fpsolve._support.arrays import Array
from fpsolve.paths.ensemble import Ensemble
from fpsolve.paths.forcing import half_step_shifts
from fpsolve.paths.integrators import Integrator
from fpsolve.web.nozzles import nozzle_parts

__all__ = ["Motion"]


@dataclass(frozen=True, eq=False)
class Motion:
    """Steps of many fibres under the force and the motion of their nozzles.

    Attributes
    ----------
    ensemble : Ensemble
    phases : ndarray, shape (n_fibres,)
        What the phase of each nozzle is ahead of that of the curve.
    first_path : int
        Number of the path that the first of these fibres follows.
    """

    ensemble: Ensemble
    phases: Array
    first_path: int = 0

    @cached_property
    def integrator(self) -> Integrator:
        """The steps of a fibre whose nozzle is in phase with the curve."""
        return self.ensemble.integrator

    @cached_property
    def weights(self) -> Array:
        """(cos φ - 1, sin φ) of every fibre; shape (2, n_fibres)."""
        half = np.sin(0.5 * self.phases)
        return np.stack([-2 * half**2, np.sin(self.phases)])

    @property
    def in_phase(self) -> bool:
        """Whether all nozzles move as the curve says."""
        return not self.phases.any()

    @property
    def ahead(self) -> float:
        """Length along the tangent from ξ after a step to the next corner of the fibre.

        A fibre of the basic model is straight from the middle of one step to that of
        the next, where it turns; a smooth one is drawn by chords from step to step.
        """
        smooth = self.integrator.n_state > N_STATE
        return 0.0 if smooth else 0.5 * self.ensemble.schedule.ds

    def advance(
        self, state: Array, first: int, step: int, n_steps: int, trace: Array | None
    ) -> None:
        """Advance the fibres from number `first` on; as `Integrator.advance`."""
        if self.in_phase:
            path = self.first_path + first
            self.integrator.advance(state, path, step, n_steps, trace)
            return
        own, path = self._own_shifts(step, n_steps), self.first_path + first
        weights = self.weights[:, first : first + state.shape[1]]
        # A single step of all fibres is no work for which threads may wait.
        with threads_worth_their_wait(state.shape[1]):
            self._advance_one_by_one(state, path, step, own, weights, trace)

    def _advance_one_by_one(
        self,
        state: Array,
        path: int,
        step: int,
        own: Array,
        weights: Array,
        trace: Array | None,
    ) -> None:
        for j in range(len(own)):
            # What a nozzle moves otherwise than the curve says is added to both halves
            # of the step, before and behind the force.
            state[:2] -= combined(own[j, 0], weights)
            here = None if trace is None else trace[j : j + 1]
            self.integrator.advance(state, path, step + j, 1, here)
            state[:2] -= combined(own[j, 1], weights)
            if trace is not None:
                trace[j, :2] = state[:2]

    def curve(self, step: int, n_steps: int) -> Array:
        """γ after every step, and what (cos φ - 1, sin φ) add; shape (n_steps, 6)."""
        schedule, curve = self.ensemble.schedule, self.ensemble.model.curve
        s = schedule.start + schedule.ds * np.arange(step + 1, step + n_steps + 1)
        columns = [*curve.position(s)]
        if self.in_phase:
            columns += [np.zeros(n_steps)] * 4
        else:
            for part in nozzle_parts(curve):
                columns += [*part.position(s)]
        return np.stack(columns, axis=1)

    def places(self, state: Array, first: int, step: int) -> Array:
        """ξ + γ of fibres after so many steps, each with the phase of its nozzle."""
        row = self.curve(step - 1, 1)[0]
        weights = self.weights[:, first : first + state.shape[1]]
        moved = combined(row[2:].reshape(2, 2).T, weights)
        return np.asarray(state[:2] + row[:2, None] + moved)

    def _own_shifts(self, step: int, n_steps: int) -> Array:
        """Displacements of both parts over the halves; shape (n_steps, 2, 2, 2)."""
        schedule, curve = self.ensemble.schedule, self.ensemble.model.curve
        parts = [
            half_step_shifts(part, schedule.start, schedule.ds, step, n_steps)
            for part in nozzle_parts(curve)
        ]
        return np.stack(parts, axis=-1)


def combined(parts: Array, weights: Array) -> Array:
    """The product (2, 2) @ (2, n), rounded alike for any number of threads of BLAS."""
    first, second = parts.T[:, :, None]
    return np.asarray(first * weights[0] + second * weights[1])
