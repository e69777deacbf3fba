"""One step of a fibre in time, its edges kept at their length."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from fpsolve._kernels.chain import Chain, Iterate, Step
from fpsolve._support.arrays import Array
from fpsolve.fibre.air import AirFlow
from fpsolve.fibre.forces import Forces
from fpsolve.fibre.halving import Halving
from fpsolve.fibre.newton import Wind, found_step
from fpsolve.fibre.string import String

__all__ = ["HalvedStep", "ThetaStep", "longer_chain", "string_chain"]

# r, v and T.
State = tuple[Array, Array, Array]


@dataclass(frozen=True, eq=False)
class ThetaStep:
    """M (v¹ − v⁰)/Δ = F(r^θ, T) + D(u − v^θ), r¹ = r⁰ + Δ v^θ, |e_i(r¹)| = h.

    r^θ = θ r¹ + (1 − θ) r⁰, v^θ likewise, M the masses. D is the force of the air
    on half of the neighbouring edges, or minus `damping` times v^θ and their length.
    Newton's method neglects how the force of the air changes with the place and the
    direction of the fibre, which costs an iteration. The tension acts along the edges
    of r^θ and is one more unknown, so that the lengths at the end of the step are
    exact. With θ = ½ it does no
    work, as |e¹|² − |e⁰|² = 2 e^½·(e¹ − e⁰) = 0, bending and weight do theirs exactly,
    and the energy is kept to the residual of Newton's method; with θ > ½ fast waves are
    damped.

    Attributes
    ----------
    string : String
    dt, theta, damping : float
    air : AirFlow or None
    """

    string: String
    dt: float
    theta: float
    damping: float
    air: AirFlow | None = None

    @cached_property
    def _held(self) -> NDArray[np.int64]:
        nodes = np.arange(self.string.n_edges + 1)
        return np.setdiff1d(nodes, self.string.moving)

    @cached_property
    def _chain(self) -> Chain:
        return string_chain(self.string)

    def __call__(
        self, r: Array, v: Array, tension: Array, t: float, force: Array | None = None
    ) -> tuple[Array, Array, Array, int]:
        """r, v, T at the end of the step that begins at time t, and the iterations.

        A `force` on the nodes, in N, shape (n + 1, 3), stays what it is for the step.

        Raises
        ------
        EdgeLengthError
            If Newton's method does not converge.
        """
        string = self.string
        iterate = Iterate(r, v, self.dt * v, tension.copy())
        iterate.moved[self._held] = 0.0
        step = Step(self.dt, self.theta, self.damping / string.line_density)
        wind = None if self.air is None else Wind(self.air, string)
        iterations = found_step(self._chain, step, iterate, wind, t, force)
        rate = iterate.moved / self.dt
        return (
            r + iterate.moved, v + (rate - v) / self.theta, iterate.tension, iterations
        )  # fmt: skip


@dataclass(eq=False)
class HalvedStep:
    """The step of a `ThetaStep`, in halves where it is not found or not accurate.

    Attributes
    ----------
    step : ThetaStep
    tolerance : float
        Of the distance of positions after one step and two halves, in m.
    middle : ndarray, shape (n + 1, 3)
        r^θ of the last step that was taken.
    """

    step: ThetaStep
    tolerance: float
    middle: Array = field(default_factory=lambda: np.empty((0, 3)), init=False)
    _iterations: int = field(default=0, init=False)
    _force: Array | None = field(default=None, init=False)
    _steps: dict[float, ThetaStep] = field(default_factory=dict, init=False)

    def __call__(
        self, r: Array, v: Array, tension: Array, t: float, force: Array | None = None
    ) -> tuple[Array, Array, Array, int]:
        """As of `ThetaStep`; the iterations of all steps that were tried.

        Raises
        ------
        EdgeLengthError
            If a step is not found, however short it is.
        ToleranceError
            If the tolerance is not reached by then.
        """
        self._iterations, self._force = 0, force
        halving = Halving(self._stepped, _apart, self.tolerance)
        r, v, tension = halving((r, v, tension), t, self.step.dt)
        return r, v, tension, self._iterations

    def _stepped(self, state: State, t: float, dt: float) -> State:
        if dt not in self._steps:
            self._steps[dt] = replace(self.step, dt=dt)
        r, v, tension, iterations = self._steps[dt](*state, t, self._force)
        self.middle = state[0] + self.step.theta * (r - state[0])
        self._iterations += iterations
        return r, v, tension


def _apart(before: State, one: State, other: State) -> float:
    """Largest distance of nodes."""
    return float(np.linalg.norm(one[0] - other[0], axis=1).max())


def string_chain(string: String) -> Chain:
    """The string as kernels know it, its held ends fixed."""
    forces, nodes = Forces(string), string.n_edges + 1
    bending = np.zeros((nodes, 5))
    for apart in (-2, -1, 0, 1, 2):
        rows = slice(max(-apart, 0), nodes - max(apart, 0))
        bending[rows, apart + 2] = forces.bending.diagonal(apart)
    fixed = np.ones((nodes, 3), dtype=bool)
    fixed[string.moving] = False
    return Chain(bending, forces.constant, string.masses, fixed, string.edge)


def longer_chain(chain: Chain, n_edges: int) -> Chain:
    """The same with more edges: nodes far from both ends are alike, such as the fifth.

    Of at least eight edges, so that this one is.
    """
    more = n_edges + 1 - chain.masses.size
    rows = np.insert(np.arange(chain.masses.size), 4, np.full(more, 4))
    bending, constant, masses, fixed, edge = chain
    return Chain(bending[rows], constant[rows], masses[rows], fixed[rows], edge)
