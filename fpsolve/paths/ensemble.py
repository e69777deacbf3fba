"""What determines an ensemble of paths, and where they start."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.errors import FpsolveError
from fpsolve.evolution.schedule import Schedule
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.paths.integrators import Integrator
from fpsolve.paths.randomness import noise_key, start_generator

__all__ = ["START_BLOCK", "Ensemble", "GivenStart", "angle_of", "state_of"]


# Paths whose starts come from one generator; part of the meaning of a seed, so that it
# must not change.
START_BLOCK = 4096
TURN = 2.0 * np.pi


@dataclass(frozen=True)
class Ensemble:
    """Everything that determines the paths of an ensemble, and what to keep of them.

    Attributes
    ----------
    model : LayDownModel or None
        None for a file whose potential or curve was the user's own code.
    n_paths : int
    schedule : Schedule
        Steps and the ones after which to keep something.
    seed : int
    method : str
    law : Law, GivenStart or None
        None when the states of the paths are known.
    keep : bool
        Whether to keep positions and states.
    grid : PhaseSpaceGrid or None
        Grid of the histograms.
    first_step : int
        Step from which on they are computed; positive while paths go on, and zero in
        every result.
    """

    model: Any
    n_paths: int
    schedule: Schedule
    seed: int
    method: str
    law: Any
    keep: bool = True
    grid: PhaseSpaceGrid | None = None
    first_step: int = 0

    def check_model(self) -> None:
        """Raise ValueError unless the model is known, as the paths go on by it."""
        if self.model is None:
            raise ValueError(
                "the model must be known for this, got paths from a file whose "
                "potential or curve was the user's own code; sample them again."
            )

    @property
    def integrator(self) -> Integrator:
        """The method, with its step and its noise."""
        key, schedule = noise_key(self.seed), self.schedule
        return Integrator(self.model, self.method, schedule.ds, schedule.start, key)

    def initial_state(self, first: int, n: int) -> Array:
        """State at which n paths from number `first` start, shape (5, n)."""
        if self.law is None:
            raise ValueError(
                "the law of the start must be known for this, got paths from a file "
                "that keeps no positions and whose law was the user's own code; sample "
                "them again."
            )
        return state_of(*self.start(first, n))

    def start(self, first: int, n: int) -> tuple[Array, Array]:
        """ξ (n, 2) and α (n,) at the start of the paths, drawn block by block."""
        blocks = range(first // START_BLOCK, (first + n - 1) // START_BLOCK + 1)
        drawn = [self._start_block(block) for block in blocks]
        here = slice(first - blocks[0] * START_BLOCK, None)
        xi = np.concatenate([xi for xi, _ in drawn])[here][:n]
        return xi, np.concatenate([alpha for _, alpha in drawn])[here][:n]

    def _start_block(self, block: int) -> tuple[Array, Array]:
        if isinstance(self.law, GivenStart):
            return self.law.block(block)
        rng = start_generator(self.seed, block)
        return checked_sample(self.law, self.law.sample(rng, START_BLOCK))


@dataclass(frozen=True, eq=False)
class GivenStart:
    """Starts given one by one.

    Attributes
    ----------
    xi : ndarray, shape (n_paths, 2)
    alpha : ndarray, shape (n_paths,)
    """

    xi: Array
    alpha: Array

    def block(self, number: int) -> tuple[Array, Array]:
        """The starts of one block."""
        here = slice(number * START_BLOCK, (number + 1) * START_BLOCK)
        return self.xi[here], self.alpha[here]

    def to_dict(self) -> dict[str, Any]:
        """Return a description; the points themselves are not in it."""
        return {"kind": "given"}


def checked_sample(law: Any, sample: Any) -> tuple[Array, Array]:
    """What a law has drawn, if it is a block of finite points."""
    xi, alpha = (np.asarray(part, dtype=np.float64) for part in sample)
    if xi.shape != (START_BLOCK, 2) or alpha.shape != (START_BLOCK,):
        raise FpsolveError(
            f"`sample` of {law!r} must return arrays of shape ({START_BLOCK}, 2) and "
            f"({START_BLOCK},) when asked for {START_BLOCK}, got {xi.shape} and "
            f"{alpha.shape}."
        )
    finite = np.isfinite(xi).all(axis=1) & np.isfinite(alpha)
    if not finite.all():
        k = int(np.argmin(finite))
        raise FpsolveError(
            f"`sample` of {law!r} must return finite points, got xi = ({xi[k, 0]:g}, "
            f"{xi[k, 1]:g}) and alpha = {alpha[k]:g}."
        )
    return xi, alpha


def state_of(xi: Array, alpha: Array) -> Array:
    """State (5, n) of paths at ξ with the unwrapped angle α."""
    cosine, sine = np.cos(alpha), np.sin(alpha)
    turns = np.rint((alpha - np.arctan2(sine, cosine)) / TURN)
    return np.stack([xi[:, 0], xi[:, 1], cosine, sine, turns])


def angle_of(state: Array) -> Array:
    """Unwrapped angle of states (…, 5, n)."""
    principal = np.arctan2(state[..., 3, :], state[..., 2, :])
    return np.asarray(principal + TURN * state[..., 4, :])
