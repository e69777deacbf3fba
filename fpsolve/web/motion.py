"""How fibres are laid step by step, each nozzle in its own phase."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fpsolve._kernels.paths import N_STATE
from fpsolve._support.arrays import Array
from fpsolve.paths.ensemble import Ensemble
from fpsolve.paths.forcing import OwnMotion
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
        own = None
        if not self.in_phase:
            weights = self.weights[:, first : first + state.shape[1]]
            own = OwnMotion(nozzle_parts(self.ensemble.model.curve), weights)
        path = self.first_path + first
        self.integrator.advance(state, path, step, n_steps, trace, own)

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


def combined(parts: Array, weights: Array) -> Array:
    """The product (2, 2) @ (2, n), rounded alike for any number of threads of BLAS."""
    first, second = parts.T[:, :, None]
    return np.asarray(first * weights[0] + second * weights[1])
