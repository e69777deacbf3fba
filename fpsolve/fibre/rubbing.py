"""A fibre that is spun and laid on a belt on which it may slide."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fpsolve._kernels.chain import Chain, Iterate, Step
from fpsolve._kernels.friction import AIR, SLIDES, STICKS, Ground
from fpsolve._support.arrays import Array
from fpsolve.errors import FrictionError
from fpsolve.fibre.ends import Belt
from fpsolve.fibre.fed_chain import KEPT_NODES, FedChain, FedStep
from fpsolve.fibre.friction import ground_under, rubbed_step, struck

__all__ = ["RubbingStep"]

# Of the largest tension on the belt: what friction of that part must hold of what
# sticks, beyond which the rest is left behind.
HELD = 2.0


@dataclass(frozen=True, eq=False)
class RubbingStep(FedStep):
    """One step of a fibre that is spun out, and rubs on the belt with a coefficient μ.

    Of what lies, every node touches the belt, N ≥ 0, and is held by |R| ≤ μN; it sticks
    or slides with R = −μN u/|u|, u the slip of the step. One that is pulled up leaves
    the belt. Nodes that come down or come to stick have an impact after the step, with
    the same law for the impulses. What sticks is left behind where friction of what
    sticks before it holds twice the largest tension on the belt, and the weight and
    momentum of a fibre from the nozzle to the belt, ρA (g H + v_in²); a step that moves
    it nevertheless is refused. Turbulence pulls at what is in the air.
    """

    def __call__(
        self, chain: FedChain, t: float, dt: float, force: Array | None = None
    ) -> tuple[FedChain, int]:
        """As of `FedStep`.

        Raises
        ------
        FrictionError
            If it does not converge, or what was left behind would slide.
        """
        numbers, fixed = self._held_in(chain)
        moved = dt * chain.v
        moved[0] = self.held(chain.newest, t + dt)[0] - chain.r[0]
        self._carry(chain, t + dt, moved)
        on = np.where(chain.sliding, SLIDES, np.where(chain.laid, STICKS, AIR))
        ground = ground_under(self._belt, fixed, on, self._carried(chain, t, dt))
        iterate = Iterate(chain.r, chain.v, moved, chain.tension.copy())
        step = Step(dt, self.theta, 0.0)
        if force is not None:
            force = np.where(chain.laid[:, None], 0.0, force)
        iterations = rubbed_step(numbers, step, iterate, self._wind, t, force, ground)
        self._check_left_behind(fixed, ground.state, t, dt)
        v = chain.v + (moved / dt - chain.v) / self.theta
        v[0] = self.held(chain.newest, t + dt)[1]
        touching = ground.may & (ground.state != AIR)
        sticks = ground.may & (ground.state == STICKS)
        # As far as it has fallen: the rest of its momentum is left to the impact.
        v[touching, 2] = moved[touching, 2] / dt
        v[sticks | fixed[:, 2]] = [self._belt.speed, 0.0, 0.0]
        v[0] = self.held(chain.newest, t + dt)[1]
        came = (touching & ~chain.laid) | (sticks & (on != STICKS))
        if came.any():
            iterations += self._strike(numbers, step, (chain.r + moved, v), t, ground)
        new = replace(chain, r=chain.r + moved, v=v, tension=iterate.tension)
        return self._lying(new, fixed[:, 2], ground.state, t + dt), iterations

    @property
    def _belt(self) -> Belt:
        assert self.belt is not None
        return self.belt

    def _held_in(self, chain: FedChain) -> tuple[Chain, NDArray[np.bool_]]:
        """The chain and what of it is held: the nozzle's, and next to what is left."""
        fixed = np.zeros((chain.laid.size, 3), dtype=bool)
        fixed[0] = True
        if chain.newest + 1 > chain.laid.size:
            fixed[-KEPT_NODES:] = True
        return self.numbers(chain.tension.size)._replace(fixed=fixed), fixed

    def _carried(self, chain: FedChain, t: float, dt: float) -> Array:
        """How far the belt takes what lies on it."""
        carried = np.zeros((chain.laid.size, 2))
        carried[:, 0] = self._belt.speed * dt
        lies = chain.laid & ~chain.sliding
        places = chain.on_belt[lies, :2] + [self._belt.speed * (t + dt), 0.0]
        carried[lies] = places - chain.r[lies, :2]
        return carried

    def _check_left_behind(
        self, fixed: NDArray[np.bool_], state: NDArray[np.int64], t: float, dt: float
    ) -> None:
        """FrictionError if the nodes beside those that are held slide."""
        if fixed[-1, 2] and state[-1 - KEPT_NODES] == SLIDES:
            raise FrictionError(t, dt, 0.0, int((state == SLIDES).sum()))

    def _strike(
        self, numbers: Chain, step: Step, state: tuple[Array, Array], t: float,
        ground: Ground,
    ) -> int:  # fmt: skip
        """Velocities after the impact, in place."""
        r, v = state
        under = ground._replace(
            carried=np.tile([self._belt.speed, 0.0], (len(r), 1)),
            may=ground.may & (ground.state != AIR),
        )
        under.carried[:] = [self._belt.speed, 0.0]
        after = Iterate(r, v.copy(), v, np.zeros(len(r) - 1))
        return struck(numbers, step, after, t, under)

    def _lying(
        self,
        chain: FedChain,
        fixed: NDArray[np.bool_],
        state: NDArray[np.int64],
        t: float,
    ) -> FedChain:
        """With what lies, where, and since when."""
        laid, sliding = state != AIR, state == SLIDES
        fixed = fixed.copy()
        fixed[0] = laid[0] = sliding[0] = False
        laid, sliding = laid | fixed, sliding & ~fixed
        on_belt = chain.on_belt.copy()
        stays = chain.laid & laid & ~chain.sliding & ~sliding
        new, moves = laid & ~chain.laid, laid & ~stays
        on_belt[moves, :2] = chain.r[moves, :2] - [self._belt.speed * t, 0.0]
        on_belt[new, 2] = t
        on_belt[~laid] = np.nan
        chain.r[laid, 2] = self._belt.height
        return replace(chain, laid=laid, sliding=sliding, on_belt=on_belt)

    def trimmed(self, chain: FedChain, t: float) -> tuple[FedChain, Array]:
        """As of `FedStep`, where friction holds what can pull at it."""
        moving = np.flatnonzero(~chain.laid | chain.sliding)
        beside = chain.laid[:-1] | chain.laid[1:]
        pull = float(np.abs(chain.tension[beside]).max(initial=0.0))
        density, speed = self.string.line_density, self.nozzle.speed
        weight = -self.string.gravity[2] * density
        fall = self.nozzle.position[2] - self._belt.height
        pull = max(HELD * pull, weight * fall + density * speed**2)
        holds = self._belt.friction * weight * self.string.edge
        if not holds > 0:
            return chain, np.empty((0, 3))
        kept = math.ceil(min(pull / holds, chain.laid.size)) + 2 * KEPT_NODES
        return chain.trimmed(self._belt, t, int(moving[-1]) + kept)
