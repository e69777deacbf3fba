"""The part of a fibre between its nozzle and the belt, which grows and is laid."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from fpsolve._kernels.chain import Chain, Iterate, Step
from fpsolve._kernels.impact import arrest
from fpsolve._support.arrays import Array
from fpsolve.fibre.air import AirFlow
from fpsolve.fibre.end_tensions import nozzle_tension
from fpsolve.fibre.ends import Belt, Nozzle
from fpsolve.fibre.newton import Wind, found_step
from fpsolve.fibre.string import FEWEST_EDGES, String
from fpsolve.fibre.theta_step import longer_chain, string_chain

__all__ = ["FedChain", "FedStep", "put_down"]

# Laid nodes that the part in the air still bends against.
KEPT_NODES = 2
# Edges of a chain whose middle a longer one repeats.
ALIKE = 8
# Of an edge: what has come out by a whole one at the end of a step, but for rounding.
ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class FedChain:
    """Nodes from the one that the nozzle holds to the last that matters.

    Attributes
    ----------
    r, v : ndarray, shape (n + 1, 3)
    tension : ndarray, shape (n,)
    laid : ndarray of bool, shape (n + 1,)
        Whether they lie on the belt.
    on_belt : ndarray, shape (n + 1, 3)
        Where, in the frame of the belt, and since when; NaN in the air.
    newest : int
        Number of the first node, counted from 0 at the end of the fibre.
    sliding : ndarray of bool, shape (n + 1,)
        Which of those that lie slide on the belt; by default none.
    """

    r: Array
    v: Array
    tension: Array
    laid: NDArray[np.bool_]
    on_belt: Array
    newest: int
    sliding: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, dtype=bool))

    def __post_init__(self) -> None:
        if not self.sliding.size:
            object.__setattr__(self, "sliding", np.zeros_like(self.laid))

    def fed(self, place: Array, velocity: Array) -> FedChain:
        """With one node more at its beginning, which the nozzle holds."""
        return FedChain(
            np.concatenate([place[None], self.r]),
            np.concatenate([velocity[None], self.v]),
            np.concatenate([self.tension[:1], self.tension]),
            np.concatenate([[False], self.laid]),
            np.concatenate([np.full((1, 3), np.nan), self.on_belt]),
            self.newest + 1,
            np.concatenate([[False], self.sliding]),
        )

    def trimmed(
        self, belt: Belt | None, t: float, last: int | None = None
    ) -> tuple[FedChain, Array]:
        """Without what lies behind the part in the air, and its `on_belt`, in turn.

        What two nodes have parted from that part for longer than `settling_time` is
        left behind as it stands: nothing that happens before them moves it. `last`
        is the last node to keep, by default two behind what is in the air.
        """
        if last is None:
            last = int(np.flatnonzero(~self.laid)[-1]) + KEPT_NODES
        if belt is not None and belt.settling_time < t:
            settled = self.on_belt[:, 2] <= t - belt.settling_time
            settled &= ~self.sliding
            pairs = np.flatnonzero(settled[:-1] & settled[1:])
            last = min([last, *(pairs[:1] + 1)])
        last = max(last, FEWEST_EDGES)
        if last >= self.laid.size - 1:
            return self, np.empty((0, 3))
        kept = slice(0, last + 1)
        chain = FedChain(
            self.r[kept], self.v[kept], self.tension[:last], self.laid[kept],
            self.on_belt[kept], self.newest, self.sliding[kept],
        )  # fmt: skip
        behind = self.on_belt[:last:-1].copy()
        standing = np.isnan(behind[:, 2])
        if standing.any():
            assert belt is not None
            places = self.r[:last:-1][standing] - [belt.speed * t, 0.0, 0.0]
            behind[standing] = places
            behind[standing, 2] = t
        return chain, behind

    @property
    def lying(self) -> Array:
        """`on_belt` of what lies behind the part in the air, from the end on."""
        last = int(np.flatnonzero(~self.laid)[-1])
        return self.on_belt[:last:-1]


@dataclass(frozen=True, eq=False)
class FedStep:
    """One step of the θ-scheme for a fibre that is spun out, and laid where it touches.

    The step is that of `ThetaStep`, with places given to the node in the nozzle and to
    those on the belt. Nodes that would be below the belt at its end are put on it by
    the same equations, their vertical coordinate given and what holds it up unknown;
    then they stick, and the other velocities follow by a plastic impact. A node
    between two that lie could still turn about both: it is put down beside them, since
    nothing holds it up but edges that are almost one, or the same.

    Attributes
    ----------
    string : String
        Of which the start is the nozzle.
    belt : Belt or None
    theta : float
    air : AirFlow or None
    """

    string: String
    belt: Belt | None
    theta: float
    air: AirFlow | None

    @property
    def nozzle(self) -> Nozzle:
        """That of the string."""
        assert isinstance(self.string.start, Nozzle)
        return self.string.start

    @cached_property
    def _wind(self) -> Wind | None:
        return None if self.air is None else Wind(self.air, self.string)

    @cached_property
    def _chains(self) -> dict[int, Chain]:
        return {}

    def numbers(self, n_edges: int) -> Chain:
        """Masses and stiffness of so many edges."""
        found = self._chains.get(n_edges)
        if found is None:
            if n_edges > ALIKE:
                found = longer_chain(self.numbers(ALIKE), n_edges)
            else:
                length = self.string.edge * n_edges
                found = string_chain(
                    replace(self.string, length=length, n_edges=n_edges)
                )
            self._chains[n_edges] = found
        return found

    def held(self, newest: int, t: float) -> tuple[Array, Array]:
        """Place and velocity of the node of this number, as the nozzle moves it."""
        place, velocity = self.nozzle.at(t)
        out = self.nozzle.speed * t - self.string.edge * (newest - self.string.n_edges)
        return place + out * np.array(self.nozzle.direction), velocity

    def __call__(
        self, chain: FedChain, t: float, dt: float, force: Array | None = None
    ) -> tuple[FedChain, int]:
        """What is there at t + dt, and the iterations of Newton's method.

        A `force` on the nodes, in N, shape (n + 1, 3), stays what it is for the step.

        Raises
        ------
        EdgeLengthError
            If it does not converge.
        """
        numbers = self.numbers(chain.tension.size)
        fixed = np.repeat(chain.laid[:, None], 3, axis=1)
        fixed[0] = True
        place, velocity = self.held(chain.newest, t + dt)
        moved = dt * chain.v
        moved[0] = place - chain.r[0]
        self._carry(chain, t + dt, moved)
        iterate = Iterate(chain.r, chain.v, moved, chain.tension.copy())
        step, iterations = Step(dt, self.theta, 0.0), 0
        while True:
            current = numbers._replace(fixed=fixed)
            iterations += found_step(current, step, iterate, self._wind, t, force)
            below = self._below(iterate) & ~fixed[:, 2]
            if not below.any():
                break
            fixed[below, 2] = True
            assert self.belt is not None
            moved[below, 2] = self.belt.height - chain.r[below, 2]
        v = chain.v + (moved / dt - chain.v) / self.theta
        v[0] = velocity
        v[chain.laid] = chain.v[chain.laid]
        new = replace(chain, r=chain.r + moved, v=v, tension=iterate.tension)
        return self._landed(new, fixed[:, 2], t + dt), iterations

    def nozzle_tension(
        self, chain: FedChain, new: FedChain, t: float, dt: float
    ) -> float:
        """T in N where the fibre leaves the nozzle, θ of the step after its begin."""
        n, theta, h = chain.tension.size, self.theta, self.string.edge
        out = self.nozzle.speed * (t + theta * dt)
        out -= h * (chain.newest - self.string.n_edges)
        middle = chain.r + theta * (new.r - chain.r)
        return nozzle_tension(self.string, self.numbers(n), middle, new.tension, out)

    def _carry(self, chain: FedChain, t: float, moved: Array) -> None:
        """Displacements of what lies on the belt."""
        if self.belt is not None:
            laid = chain.laid
            moved[laid] = 0.0
            at = chain.on_belt[laid, 0] + self.belt.speed * t
            moved[laid, 0] = at - chain.r[laid, 0]

    def _below(self, iterate: Iterate) -> NDArray[np.bool_]:
        """Nodes that would be below the belt at the end of the step."""
        if self.belt is None:
            return np.zeros(len(iterate.r), dtype=bool)
        return iterate.r[:, 2] + iterate.moved[:, 2] < self.belt.height

    def _landed(self, chain: FedChain, down: NDArray[np.bool_], t: float) -> FedChain:
        """With the velocity of the belt where it has just been reached."""
        landed = down & ~chain.laid
        landed[0] = False
        if not landed.any():
            return chain
        assert self.belt is not None
        laid, on_belt = chain.laid | landed, chain.on_belt.copy()
        between = np.zeros_like(laid)
        between[1:-1] = laid[:-2] & laid[2:] & ~laid[1:-1]
        for i in np.flatnonzero(between):
            chain.r[i] = put_down(chain.r[i - 1 : i + 2], self.string.edge)
        laid, landed = laid | between, landed | between
        on_belt[landed] = chain.r[landed] - [self.belt.speed * t, 0.0, 0.0]
        on_belt[landed, 2] = t
        chain.r[landed, 2] = self.belt.height
        chain.v[landed] = [self.belt.speed, 0.0, 0.0]
        v = self.arrested(chain.r, chain.v, laid)
        return replace(chain, v=v, laid=laid, on_belt=on_belt)

    def arrested(self, r: Array, v: Array, laid: NDArray[np.bool_]) -> Array:
        """Velocities that stretch no edge, those of the nozzle and the belt given."""
        held, v = laid.copy(), v.copy()
        held[0] = True
        arrest(r, self.numbers(len(r) - 1).masses, held, v)
        return v

    def trimmed(self, chain: FedChain, t: float) -> tuple[FedChain, Array]:
        """Without what is left behind, and that, as `FedChain.trimmed` has it."""
        return chain.trimmed(self.belt, t)

    def after_feeding(self, chain: FedChain, t: float) -> FedChain:
        """With the nodes that the nozzle has let go until then."""
        while True:
            out = self.nozzle.speed * t
            out -= self.string.edge * (chain.newest - self.string.n_edges)
            if not out >= (1 - ROUNDING) * self.string.edge:
                return chain
            # An edge behind the last, and not where `held` has it to rounding of all
            # that has come out, which edges would show.
            behind = self.string.edge * np.array(self.nozzle.direction)
            chain = chain.fed(chain.r[0] - behind, self.held(chain.newest, t)[1])


def put_down(three: Array, edge: float) -> Array:
    """Where the second of three nodes lies if both others do, on the side it is on."""
    across = 0.5 * (three[2] - three[0])
    middle = three[0] + across
    half = float(np.linalg.norm(across))
    aside = three[1] - middle
    aside[2] = 0.0
    if half:
        aside -= (aside @ across) / half**2 * across
    size = float(np.linalg.norm(aside))
    if not size > ROUNDING * edge:
        # From above the middle it may fall to either side.
        aside = (
            np.array([-across[1], across[0], 0.0]) if half else np.array([edge, 0, 0])
        )
        size = float(np.linalg.norm(aside))
    height = math.sqrt(max(edge**2 - half**2, 0.0))
    return np.asarray(middle + height / size * aside)
