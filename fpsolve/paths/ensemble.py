"""What determines an ensemble of paths, and where they start."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.errors import FpsolveError
from fpsolve.evolution.schedule import Schedule
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.paths.integrators import Integrator
from fpsolve.paths.randomness import noise_key, start_generator
from fpsolve.paths.samplers import integrator_of

__all__ = ["KAPPA", "START_BLOCK", "Ensemble", "GivenStart", "angle_of", "state_of"]


# Paths whose starts come from one generator; part of the meaning of a seed, so that it
# must not change.
START_BLOCK = 4096
TURN = 2.0 * np.pi
# Place of the curvature in the state of a smooth path.
KAPPA = 5


@dataclass(frozen=True)
class Ensemble:
    """Everything that determines the paths of an ensemble, and what to keep of them.

    Attributes
    ----------
    model : FibreModel or None
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
        made = integrator_of(self.model)
        return made(self.model, self.method, schedule.ds, schedule.start, key)

    @property
    def n_state(self) -> int:
        """Numbers of which the state of a path consists."""
        return integrator_of(self.model).n_state

    def initial_state(self, first: int, n: int) -> Array:
        """State at which n paths from number `first` start, shape (n_state, n)."""
        if self.law is None:
            raise ValueError(
                "the law of the start must be known for this, got paths from a file "
                "that keeps no positions and whose law was the user's own code; sample "
                "them again."
            )
        return state_of(*self.start(first, n))

    def start(self, first: int, n: int) -> tuple[Array, ...]:
        """ξ (n, 2), α (n,) and, of a smooth model, κ (n,) at the start of the paths.

        They are drawn block by block.
        """
        blocks = range(first // START_BLOCK, (first + n - 1) // START_BLOCK + 1)
        drawn = [self._start_block(block) for block in blocks]
        here = slice(first - blocks[0] * START_BLOCK, None)
        parts = zip(*drawn, strict=True)
        return tuple(np.concatenate(part)[here][:n] for part in parts)

    def _start_block(self, block: int) -> tuple[Array, ...]:
        rng = start_generator(self.seed, block)
        if isinstance(self.law, GivenStart):
            start = self.law.block(block)
        else:
            start = checked_sample(self.law, self.law.sample(rng, START_BLOCK))
        xi, alpha, *kappa = start
        smooth = isinstance(self.model, SmoothLayDownModel)
        if smooth and not kappa:
            spread = np.sqrt(self.model.curvature_variance)
            drawn = spread * rng.standard_normal(START_BLOCK)
            return xi, alpha, drawn[: len(alpha)]
        if kappa and not smooth:
            raise FpsolveError(
                f"`sample` of {self.law!r} must return xi and alpha for a model "
                "without curvature, got a third array; use SmoothLayDownModel."
            )
        return start


@dataclass(frozen=True, eq=False)
class GivenStart:
    """Starts given one by one.

    Attributes
    ----------
    xi : ndarray, shape (n_paths, 2)
    alpha : ndarray, shape (n_paths,)
    kappa : ndarray, shape (n_paths,), optional
    """

    xi: Array
    alpha: Array
    kappa: Array | None = None

    @property
    def parts(self) -> dict[str, Array]:
        """What is given, by name."""
        given = {"xi": self.xi, "alpha": self.alpha}
        return given if self.kappa is None else {**given, "kappa": self.kappa}

    def block(self, number: int) -> tuple[Array, ...]:
        """The starts of one block."""
        here = slice(number * START_BLOCK, (number + 1) * START_BLOCK)
        return tuple(part[here] for part in self.parts.values())

    def to_dict(self) -> dict[str, Any]:
        """Return a description; the points themselves are not in it."""
        return {"kind": "given"}


def checked_sample(law: Any, sample: Any) -> tuple[Array, ...]:
    """What a law has drawn, if it is a block of finite points: ξ, α and perhaps κ."""
    parts = tuple(np.asarray(part, dtype=np.float64) for part in sample)
    (xi, alpha), kappa = parts[:2], parts[2:]
    shape = (START_BLOCK,)
    if xi.shape != (START_BLOCK, 2) or alpha.shape != shape:
        raise FpsolveError(
            f"`sample` of {law!r} must return arrays of shape ({START_BLOCK}, 2) and "
            f"({START_BLOCK},) when asked for {START_BLOCK}, got {xi.shape} and "
            f"{alpha.shape}."
        )
    if kappa and not [part.shape for part in kappa] == [shape]:
        raise FpsolveError(
            f"`sample` of {law!r} must return one array of shape ({START_BLOCK},) for "
            f"kappa, got {[part.shape for part in kappa]}."
        )
    finite = np.isfinite(xi).all(axis=1) & np.isfinite([alpha, *kappa]).all(axis=0)
    if not finite.all():
        k = int(np.argmin(finite))
        raise FpsolveError(
            f"`sample` of {law!r} must return finite points, got xi = ({xi[k, 0]:g}, "
            f"{xi[k, 1]:g}) and alpha = {alpha[k]:g}"
            f"{''.join(f' and kappa = {part[k]:g}' for part in kappa)}."
        )
    return parts


def state_of(xi: Array, alpha: Array, *kappa: Array) -> Array:
    """State (5, n) or (6, n) of paths at ξ with the unwrapped angle α, perhaps κ."""
    cosine, sine = np.cos(alpha), np.sin(alpha)
    turns = np.rint((alpha - np.arctan2(sine, cosine)) / TURN)
    return np.stack([xi[:, 0], xi[:, 1], cosine, sine, turns, *kappa])


def angle_of(state: Array) -> Array:
    """Unwrapped angle of states (…, n_state, n)."""
    principal = np.arctan2(state[..., 3, :], state[..., 2, :])
    return np.asarray(principal + TURN * state[..., 4, :])
