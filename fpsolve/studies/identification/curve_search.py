"""Parameters by Γ_α and Γ_κ at several lags, where their largest values do not do."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.errors import ToleranceError
from fpsolve.studies.identification.increments import Squares, squares
from fpsolve.studies.identification.quasi_newton import LARGEST_STEP, Search
from fpsolve.studies.identification.sampling_error import bootstrap_covariance
from fpsolve.studies.identification.second_order import (
    Allowed,
    Response,
    allowed,
    fitted,
    widened,
)
from fpsolve.studies.identification.surrogate import LONGEST_REACH, whole_periods

__all__ = ["CurveSearch"]

# Lags between 1 and k_max, at equal ratios.
N_LAGS = 4
# Points of a surrogate at least, and units of σ that it runs after other parameters:
# little noise forgets them late.
FEWEST_POINTS, LONG_RUN = 1500, 15.0
# Damped Newton steps to begin with, and the change that measures their slopes; a step
# counts as an error of one in a logarithm, a surrogate as one of two per cent.
N_APPROACH, CHANGE, DAMPING, ROUGHNESS = 5, 0.2, 1.0, 0.02
# Standard deviations of the logarithms of points of a round, at least: narrower ones do
# not see the other side of a fold, which is as likely.
LEAST_SPREAD = (0.15, 0.2, 0.25, 0.05)
# Points of a round, how much wider they are, and how many rounds there may be.
N_POINTS, WIDER, MOST_ROUNDS = 40, 1.2, 8
# Standard errors by which the mean may still move.
STILL = 0.5


@dataclass
class CurveSearch:
    """Parameters P with (⟨ξ₁²⟩, ⟨ξ₂²⟩, Γ_α(h_j), Γ_κ(h_j)) of a fibre, h_j ≤ k_max Δs.

    At little noise a fibre circles: Γ_α grows up to k_max whatever A is, and F(P)
    folds, so that F(P) = F has two solutions near each other or none. Γ at other lags
    tells them. As there are more numbers than parameters, they are met in units of
    their errors, which are those of the surrogates of every P.

    Attributes
    ----------
    search : Search
        Whose fibre, lags and surrogates are taken.
    """

    search: Search
    history: list[Array] = field(default_factory=list)

    def __post_init__(self) -> None:
        search = self.search
        wanted = np.geomspace(1, search.k_max, N_LAGS)
        nearest = np.abs(search.lags[:, None] - wanted).argmin(axis=0)
        self.chosen = np.unique(nearest)
        self.target = self.numbers(search.data)[:, 0]
        self.total = len(search.fibre.eta)
        least = max(FEWEST_POINTS, LONGEST_REACH * search.k_max)
        self.n_points = whole_periods(search.fibre, min(self.total, least))
        search.surrogate.next_run = LONG_RUN

    @property
    def h(self) -> Array:
        """Lags at which Γ is compared."""
        return np.asarray(self.search.lags[self.chosen] * self.search.fibre.ds)

    def numbers(self, found: Squares) -> Array:
        """Logarithms of what is compared, (m, n_fibres); Γ_κ of smooth fibres only."""
        parts = [found.xi[2:4], found.angle[self.chosen]]
        if self.search.n == 4:
            parts.append(found.curvature[self.chosen])
        return np.asarray(0.5 * np.log(np.concatenate(parts)))

    def law(self, logs: Array) -> tuple[Array, Array]:
        """Mean of the numbers at these parameters, and their covariance for the data.

        Surrogates shorter than the data scatter more by the ratio of the lengths.
        """
        search = self.search
        sample = search.surrogate.sample(search.model(logs), self.n_points)
        drawn = self.numbers(squares([sample], search.lags, search.fibre.ds))
        return drawn.mean(axis=1), np.cov(drawn) * self.n_points / self.total

    def run(self) -> Allowed:
        """Mean and covariance of the logarithms of the parameters.

        Raises
        ------
        ToleranceError
            If they do not settle.
        """
        n, seed = self.search.n, self.search.seed
        rng = np.random.default_rng(seed)
        mean, least = self._approached(), np.diag(LEAST_SPREAD[:n]) ** 2
        covariance, rounds, moved = least, [], np.inf
        for _ in range(MOST_ROUNDS):
            scale = WIDER * np.linalg.cholesky(covariance)
            points = mean + rng.standard_normal((N_POINTS, n)) @ scale.T
            means, spreads = zip(*map(self.law, points), strict=True)
            rounds.append((points, np.array(means), np.array(spreads)))
            response = fitted(*map(np.concatenate, zip(*rounds[-2:], strict=True)))
            found = allowed(response, self.target, seed)
            self.history.append(np.exp(found.mean))
            moved = _distance(mean, found)
            if found.settled and len(rounds) > 1 and moved < STILL:
                return self._corrected(found, response)
            mean, covariance = found.mean, found.covariance + least
        raise ToleranceError(
            moved, STILL,
            "the increments of this fibre are those of no parameters near its own: "
            "look at them by `increment_curves`, or take another model",
        )  # fmt: skip

    def _approached(self) -> Array:
        """Damped Newton steps from log F."""
        logs, n = self.search.target.copy(), self.search.n
        for _ in range(N_APPROACH):
            mean, covariance = self.law(logs)
            slopes = np.stack([
                (self.law(logs + change)[0] - self.law(logs - change)[0]) / (2 * CHANGE)
                for change in CHANGE * np.eye(n)
            ], axis=1)  # fmt: skip
            rough = covariance + ROUGHNESS**2 * np.eye(len(mean))
            weighted = np.linalg.solve(rough, slopes).T
            step = np.linalg.solve(
                weighted @ slopes + DAMPING * np.eye(n), weighted @ (self.target - mean)
            )
            logs = logs + step * min(1.0, LARGEST_STEP / np.abs(step).max())
            self.history.append(np.exp(logs))
        return logs

    def _corrected(self, found: Allowed, response: Response) -> Allowed:
        """With the bias of fibres of this length, and their own scatter if larger."""
        search = self.search
        here = response.mean(found.mean[None])[0]
        bias = self.numbers(search.replicates(found.mean)).mean(axis=1) - here
        own = bootstrap_covariance(search.fibre, search.lags, search.seed, self.numbers)
        if own is not None:
            spread = response.spread(found.mean[None])[0]
            response = widened(
                response, np.maximum(1.0, np.sqrt(np.diag(own)) / spread)
            )
        return allowed(response, self.target - bias, search.seed)


def _distance(mean: Array, found: Allowed) -> float:
    """Of the new mean from the old one, in standard errors."""
    unit = np.linalg.cholesky(found.covariance)
    return float(np.linalg.norm(np.linalg.solve(unit, found.mean - mean)))
