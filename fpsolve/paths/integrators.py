"""Steps of the stochastic differential equation (6) for many paths.

dξ = τ(α) ds - dγ,  dα = -∇B(ξ)·τ⊥(α) ds + A dW.

The state of n paths is an array of shape (5, n): ξ1, ξ2, cos α, sin α and the number
of full turns. The angle is kept as its cosine and sine, which every step needs.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fpsolve._kernels import paths as kernels
from fpsolve._support.arrays import Array
from fpsolve.errors import NonFinitePathError
from fpsolve.model.fibre import FibreModel
from fpsolve.paths.forcing import OwnMotion, compiled_potential, step_shifts

__all__ = ["Integrator", "displace", "translate"]

Gradient = Callable[[Array], Array]

# Normal numbers that one call of the generator gives.
N_NORMALS = 4


@dataclass(frozen=True)
class Integrator:
    """One method with one step for one model and one stream of noise.

    "splitting" is T½ R½ D R½ T½, where T moves ξ at fixed α, R is the exact flow of
    the angle at fixed ξ and D the noise: weakly of order 2, and safe for every force
    and every noise, as the angle never moves by a difference quotient.
    "euler_maruyama" is weakly of order 1, "heun" (stochastic Heun) weakly of order 2.

    Attributes
    ----------
    model : FibreModel
    method : str
    ds, s_start : float
    key : (int, int)
        From `noise_key`.
    """

    methods: ClassVar = {
        "splitting": kernels.SPLITTING,
        "euler_maruyama": kernels.EULER_MARUYAMA,
        "heun": kernels.HEUN,
    }
    # Beyond this |∇B| ds a path is reflected by a step instead of being turned by a
    # force: where many are, no method is of its order any more. For B = ‖ξ‖⁶⁰/60 the
    # splitting is off by 3 % in E‖ξ‖² where 4 % are, and by 1 % where 1 % are.
    largest_turn: ClassVar = 2.5
    # Rows of a state.
    n_state: ClassVar = kernels.N_STATE

    model: FibreModel
    method: str
    ds: float
    s_start: float
    key: tuple[int, int]

    @property
    def noise_scale(self) -> float:
        """A √ds."""
        return self.model.noise * math.sqrt(self.ds)

    def advance(
        self,
        state: Array,
        path: int,
        step: int,
        n_steps: int,
        trace: Array | None = None,
        own: OwnMotion | None = None,
    ) -> None:
        """Advance the state in place; `trace` receives it after every step.

        Parameters
        ----------
        state : ndarray, shape (n_state, n_paths)
        path, step : int
            Number of the first path and of the first step.
        n_steps : int
        trace : ndarray, shape (n_steps, n_state, n_paths), optional
        own : OwnMotion, optional
            Where nozzles do not all move as the curve.

        Raises
        ------
        NonFinitePathError
            If a gradient or a position is not finite.
        """
        before = state.copy()
        if trace is None:
            trace = np.zeros((0, self.n_state, 0))
        shifts = self._shifts(step, n_steps, own)
        self._take(state, path, step, shifts, trace)
        # A sum is finite unless one of its terms is not.
        if not math.isfinite(float(state.sum())):
            bad = int(np.argmin(np.isfinite(state).all(axis=0)))
            shifts = self._shifts(step, n_steps, None if own is None else own.of(bad))
            self._complain(before[:, bad : bad + 1], path + bad, step, shifts)

    def n_fast(self, state: Array) -> int:
        """Paths at whose place |∇B| ds is above `largest_turn`."""
        with np.errstate(all="ignore"):
            slopes = self.model.potential.gradient(state[0], state[1])
            turn = self.ds * np.hypot(*slopes)
        return int(np.count_nonzero(turn > self.largest_turn))

    def _shifts(self, step: int, n_steps: int, own: OwnMotion | None) -> kernels.Shifts:
        curve = self.model.curve
        return step_shifts(curve, own, self.s_start, self.ds, step, n_steps)

    def _take(
        self, state: Array, path: int, step: int, shifts: kernels.Shifts, trace: Array
    ) -> None:
        potential = compiled_potential(self.model.potential)
        if potential is None:
            self._take_staged(state, path, step, shifts, trace)
            return
        noise = kernels.Noise(path, step, self.key, self.noise_scale)
        method = self.methods[self.method]
        kernels.advance_paths(noise, self.ds, potential, shifts, method, trace, state)

    def _take_staged(
        self, state: Array, path: int, step: int, shifts: kernels.Shifts, trace: Array
    ) -> None:
        """Step by step, with a gradient that is the user's own code."""
        take = STAGES[self.method]
        normals = np.empty((N_NORMALS, state.shape[1]))
        for j, common in enumerate(shifts.common):
            group, number = divmod(step + j, N_NORMALS)
            if j == 0 or number == 0:
                kernels.fill_normals(path, group, self.key, normals)
            gradient = self._gradient(path, step + j)
            angles = self.noise_scale * normals[number]
            displace(state, shifts, j, 0)
            take(state, self.ds, angles, common, gradient)
            displace(state, shifts, j, 1)
            if len(trace):
                trace[j] = state

    def _gradient(self, path: int, step: int) -> Gradient:
        """∇B at the positions of a state, shape (2, n_paths), checked."""

        def gradient(state: Array) -> Array:
            forces = np.stack(self.model.potential.gradient(state[0], state[1]))
            finite = np.isfinite(forces).all(axis=0)
            if not finite.all():
                bad = int(np.argmin(finite))
                s = self.s_start + step * self.ds
                raise NonFinitePathError(
                    path + bad, s, state[:2, bad].tolist(), forces[:, bad].tolist()
                )
            return forces

        return gradient

    def _complain(
        self, state: Array, path: int, step: int, shifts: kernels.Shifts
    ) -> None:
        """Raise with the place where one path was last finite."""
        n_steps = len(shifts.common)
        state, trace = state.copy(), np.empty((n_steps, self.n_state, 1))
        trace[...] = np.nan
        start = state[None].copy()
        self._take(state, path, step, shifts, trace)
        visited = np.concatenate([start, trace])[:, :, 0]
        last = int(np.argmin(np.isfinite(visited).all(axis=1))) - 1
        place = visited[last, :2]
        with np.errstate(all="ignore"):
            slopes = [float(slope) for slope in self.model.potential.gradient(*place)]
        s = self.s_start + (step + last) * self.ds
        raise NonFinitePathError(path, s, place.tolist(), slopes)


def translate(state: Array, ds: float, shift: Array) -> None:
    """ξ ← ξ + ds τ - (displacement of γ)."""
    state[:2] += ds * state[2:4] - shift[:, None]


def displace(state: Array, shifts: kernels.Shifts, j: int, half: int) -> None:
    """ξ less what nozzles add to γ over one half of step j of every path."""
    if shifts.weights.size:
        first, second = shifts.own[j, half].T[:, :, None]
        state[:2] -= first * shifts.weights[0] + second * shifts.weights[1]


def angular_drift(state: Array, forces: Array) -> Array:
    """-∇B·τ⊥."""
    drift: Array = forces[0] * state[3] - forces[1] * state[2]
    return drift


def splitting_step(
    state: Array, ds: float, angles: Array, shifts: Array, gradient: Gradient
) -> None:
    """T½ R½ D R½ T½."""
    translate(state, 0.5 * ds, shifts[0])
    kernels.kick_paths(0.25 * ds, angles, gradient(state), state)
    translate(state, 0.5 * ds, shifts[1])


def euler_maruyama_step(
    state: Array, ds: float, angles: Array, shifts: Array, gradient: Gradient
) -> None:
    """Both drifts at the beginning of the step."""
    turned = ds * angular_drift(state, gradient(state)) + angles
    translate(state, ds, shifts.sum(axis=0))
    kernels.rotate_paths(turned, state)


def heun_step(
    state: Array, ds: float, angles: Array, shifts: Array, gradient: Gradient
) -> None:
    """Means of the drifts at both ends of an Euler-Maruyama step."""
    ahead = state.copy()
    drift = angular_drift(state, gradient(state))
    translate(ahead, ds, shifts.sum(axis=0))
    kernels.rotate_paths(ds * drift + angles, ahead)
    drift_ahead = angular_drift(ahead, gradient(ahead))
    translate(state, 0.5 * ds, shifts.sum(axis=0))
    state[:2] += 0.5 * ds * ahead[2:4]
    kernels.rotate_paths(0.5 * ds * (drift + drift_ahead) + angles, state)


STAGES = {
    "splitting": splitting_step,
    "euler_maruyama": euler_maruyama_step,
    "heun": heun_step,
}
