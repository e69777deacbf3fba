"""The relaxed quasi-Newton method with unit Jacobian, and what is averaged of it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.model.fibre import FibreModel
from fpsolve.paths.fibres.fibre_curve import FibreCurve
from fpsolve.studies.identification.increments import (
    NAMES,
    Squares,
    checked_k_max,
    lags_up_to,
    log_functional,
    samples_of,
    squares,
)
from fpsolve.studies.identification.surrogate import (
    LONGEST_REACH,
    N_FIBRES,
    Surrogate,
    model_of,
    whole_periods,
)

__all__ = ["Search"]

# ω, and the largest logarithm of a factor in one iteration.
RELAXATION, LARGEST_STEP = 0.6, 0.5
# Iterations until the parameters are about right, and those that are averaged.
N_APPROACH, N_AVERAGED = 15, 20
# Relative change of a parameter whose effect is measured, and how many samples more
# than of an iteration it takes.
CHANGE, N_MORE = 0.15, 4
# Rounds of averaging, after each of which the measured slopes correct what is left, and
# what may be left at the end.
MOST_ROUNDS, LEFT = 4, 0.1
# ∂ log max Γ_α/∂ log A of smooth fibres, below which they circle whatever A is.
LEAST_ANSWER = 0.1
# Largest relative standard error of a parameter that counts as determined; a singular
# value of the slopes below its inverse moves nothing.
WEAKEST_SLOPE = 0.02


@dataclass
class Search:
    """Parameters P with F(P) = F for the functional F of a fibre.

    P ← P exp(ω clip(log F/F(P))), with fresh noise in every iteration. The update with
    F - F(P) itself, unit Jacobian, diverges for some parameters; this one cannot leave
    the positive numbers nor jump.

    Attributes
    ----------
    fibre : FibreCurve
    n : int
        Number of parameters: three of the basic model, four of the smooth one.
    k_max : int
    samples : int
        Points that an iteration draws, at least.
    seed : int
    """

    fibre: FibreCurve
    n: int
    k_max: int
    samples: int
    seed: int
    history: list[Array] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.lags = lags_up_to(checked_k_max(self.fibre, self.k_max))
        self.surrogate = Surrogate(self.fibre, self.seed)
        self.data = squares(samples_of(self.fibre), self.lags, self.fibre.ds)
        self.target = log_functional(self.data)[: self.n, 0]
        least = max(self.samples // N_FIBRES, LONGEST_REACH * self.k_max)
        self.n_points = whole_periods(self.fibre, least)

    def model(self, logs: Array) -> FibreModel:
        """The model of parameters by their logarithms."""
        assert self.fibre.curve is not None
        parameters = dict(zip(NAMES, np.exp(logs).tolist(), strict=False))
        return model_of(parameters, self.fibre.curve)

    def residual(self, logs: Array, more: int = 1) -> Array:
        """log F/F(P), with fresh noise."""
        sample = self.surrogate.sample(self.model(logs), more * self.n_points)
        found = squares([sample], self.lags, self.fibre.ds).pooled()
        return np.asarray(self.target - log_functional(found)[: self.n, 0])

    def replicates(self, logs: Array) -> Squares:
        """64 surrogates of the size of the data, at these parameters."""
        return squares(
            self.surrogate.pieces(self.model(logs)), self.lags, self.fibre.ds
        )

    def run(self) -> tuple[Array, Array] | None:
        """Logarithms of the parameters, and the slopes ∂ log F/∂ log P there.

        None if the iterates do not settle, or where F does not answer to A.
        """
        logs = self._approached(self.target.copy())
        # Before the rounds, for these take longer.
        if not self._answers(logs):
            return None
        for _ in range(MOST_ROUNDS):
            iterates, left = self._averaged(logs)
            slopes = self.slopes(iterates)
            if self.n == 4 and not slopes[2, 2] > LEAST_ANSWER:
                return None
            step = corrected(slopes, left)
            logs = iterates + step
            if np.abs(step).max() < LEFT:
                return logs, slopes
        return None

    def _answers(self, logs: Array) -> bool:
        """Whether max Γ_α of smooth fibres grows with A."""
        if self.n < 4:
            return True
        change = CHANGE * np.eye(4)[2]
        ends = [self.residual(logs + sign * change, N_MORE)[2] for sign in (1, -1)]
        return bool(ends[1] - ends[0] > 2 * CHANGE * LEAST_ANSWER)

    def _approached(self, logs: Array) -> Array:
        for _ in range(N_APPROACH):
            logs = self._next(logs, self.residual(logs))
        return logs

    def _next(self, logs: Array, residual: Array) -> Array:
        step = np.clip(residual, -LARGEST_STEP, LARGEST_STEP)
        logs = logs + RELAXATION * step
        self.history.append(np.exp(logs))
        return logs

    def _averaged(self, logs: Array) -> tuple[Array, Array]:
        """Mean of iterates, and of what is left of log F/F(P) at them."""
        places, left = [], []
        for _ in range(N_AVERAGED):
            found = self.residual(logs)
            places.append(logs)
            left.append(found)
            logs = self._next(logs, found)
        return np.mean(places, axis=0), np.mean(left, axis=0)

    def slopes(self, logs: Array) -> Array:
        """∂ log F/∂ log P by central differences."""
        found = np.empty((self.n, self.n))
        for j, change in enumerate(CHANGE * np.eye(self.n)):
            above, below = (
                self.residual(logs + sign * change, N_MORE) for sign in (1, -1)
            )
            found[:, j] = (below - above) / (2 * CHANGE)
        return found


def corrected(slopes: Array, left: Array) -> Array:
    """The Newton step for what is left, no longer than that of an iteration."""
    step = np.linalg.pinv(slopes, rcond=WEAKEST_SLOPE) @ left
    return np.asarray(np.clip(step, -LARGEST_STEP, LARGEST_STEP))
