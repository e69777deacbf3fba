"""Steps of the stochastic differential equation (22) for many paths.

dξ = τ(α) ds - dγ,  dα = κ ds,  dκ = -(κ + ∇B(ξ)·τ⊥(α))/R ds + K dW.

The state of n paths is an array of shape (6, n): that of the basic model and κ.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from fpsolve._kernels import paths as kernels
from fpsolve._support.arrays import Array
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.paths.forcing import compiled_potential
from fpsolve.paths.integrators import Integrator, displace, translate
from fpsolve.paths.smooth_step import smooth_step

__all__ = ["SmoothIntegrator"]


class SmoothIntegrator(Integrator):
    """The step of the smooth model, for any relaxation length R.

    "splitting" takes the force at ξ + (h/2) τ and draws the noise of (κ, α, ∫α) over
    the step together from their Gaussian; the force acts through the mean tangent of
    the step, which also moves ξ. Weakly of order 2, uniformly in R: for
    R → 0 it becomes a splitting of the basic model. Exact in κ and α without potential.
    """

    methods: ClassVar = {"splitting": kernels.SPLITTING}
    n_state: ClassVar = kernels.N_SMOOTH_STATE

    model: SmoothLayDownModel

    @property
    def step(self) -> kernels.SmoothStep:
        """Weights and noise of a step."""
        model = self.model
        return smooth_step(model.relaxation_length, model.noise, self.ds)

    def _take(
        self, state: Array, path: int, step: int, shifts: kernels.Shifts, trace: Array
    ) -> None:
        potential = compiled_potential(self.model.potential)
        if potential is None:
            self._take_staged(state, path, step, shifts, trace)
            return
        kernels.advance_smooth_paths(
            path, step, self.key, self.step, potential, shifts, trace, state
        )

    def _take_staged(
        self, state: Array, path: int, step: int, shifts: kernels.Shifts, trace: Array
    ) -> None:
        """Step by step, with a gradient that is the user's own code."""
        law, n_steps = self.step, kernels.N_STEPS
        numbers = np.empty((kernels.N_NUMBERS, n_steps, state.shape[1]))
        for j, common in enumerate(shifts.common):
            group, number = divmod(step + j, n_steps)
            if j == 0 or number == 0:
                self._draw(path, group, numbers)
            displace(state, shifts, j, 0)
            translate(state, 0.5 * self.ds, common[0])
            forces = self._gradient(path, step + j)(state)
            # Three numbers after the other for each step of the four.
            own = numbers.reshape(n_steps, kernels.N_NUMBERS, -1)[number]
            kernels.turn_paths(law, own, forces, common[1], state)
            displace(state, shifts, j, 1)
            if len(trace):
                trace[j] = state

    def _draw(self, path: int, group: int, numbers: Array) -> None:
        """Three times the four numbers that one call of the generator gives."""
        for part, normals in enumerate(numbers):
            counter = kernels.N_NUMBERS * group + part
            kernels.fill_normals(path, counter, self.key, normals)
